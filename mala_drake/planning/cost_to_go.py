"""Value iteration on a state graph: the exact cost to go from every state (row A5)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from mala_drake.planning.state_graph import ExactArray, StateGraph


@dataclass(frozen=True, slots=True, eq=False)
class CostToGo:
    """What value iteration finds. Costs are minimised: an action value of row F5, which is a reward, is minus these.

    Attributes:
        graph: that it is of.
        values: (n,), exact, in multiples of the graph's unit; meaningless where `solvable` is not true.
        solvable: (n,), whether a goal can be reached.
        sweeps: over all states until nothing changed.
    """

    graph: StateGraph
    values: ExactArray
    solvable: npt.NDArray[np.bool_]
    sweeps: int

    def cost(self, state: int = 0) -> Fraction | None:
        """The optimal cost from a state to a goal in the units of the metric; None if none can be reached."""
        return int(self.values[state]) * self.graph.unit if self.solvable[state] else None

    def plan(self, state: int = 0) -> tuple[str, ...]:
        """An optimal plan from a state: in each state the first action that keeps the Bellman equation.

        Raises:
            ValueError: if no goal can be reached from there, or costs of zero lead round in a circle.
        """
        if not self.solvable[state]:
            raise ValueError(f"no goal can be reached from state {state}")
        graph, offsets, actions = self.graph, self.graph.offsets, []
        while not graph.goals[state]:
            edges = range(offsets[state], offsets[state + 1])
            state, name = next(
                (graph.ends[edge], graph.names[graph.actions[edge]])
                for edge in edges
                if self.solvable[graph.ends[edge]]
                and graph.costs[edge] + self.values[graph.ends[edge]] == self.values[state]
            )
            actions.append(name)
            if len(actions) > graph.size:
                raise ValueError("actions without cost lead round in a circle")
        return tuple(actions)

    def action_values(self) -> npt.NDArray[np.float64]:
        """Q(s, a) = c(s, a) + V(s') of each transition, in the units of the metric: (m,); infinite into dead ends."""
        ends = self.graph.ends
        totals = (self.graph.costs + self.values[ends]).astype(float) * float(self.graph.unit)
        return np.where(self.solvable[ends], totals, np.inf)


def value_iteration(graph: StateGraph) -> CostToGo:
    """Sweeps V(s) <- min_a c(s, a) + V(s') over all states at once, from V = 0 at goals and infinity elsewhere.

    After k sweeps V is the cost of the best plan of at most k actions, so that with costs >= 0 it ends after as many
    sweeps as the longest optimal plan has actions, and one more.

    Raises:
        ValueError: if a cost is negative: then there may be no cheapest plan.
    """
    if np.any(graph.costs < 0):
        raise ValueError("a cost is negative")
    acting = np.flatnonzero(np.diff(graph.offsets))
    first = graph.offsets[acting]
    infinite = int(graph.costs.max()) * graph.size + 1 if graph.costs.size else 1
    values = np.full(graph.size, infinite, dtype=graph.costs.dtype)
    values[graph.goals] = 0
    sweeps = 0
    while acting.size:
        sweeps += 1
        best = np.minimum.reduceat(graph.costs + values[graph.ends], first)
        better = best < values[acting]
        if not better.any():
            break
        values[acting[better]] = best[better]
    return CostToGo(graph, values, values < infinite, sweeps)
