"""Q-learning on a state graph: action values from experience alone (row A5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.planning.state_graph import StateGraph

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class QLearning:
    """Q(s, a) <- Q(s, a) + alpha (c + min_a' Q(s', a') - Q(s, a)) along episodes of an epsilon-greedy policy.

    Costs are minimised: Q is minus the action value of the paper's F5. It starts at 0, below every true value, so that
    what was not tried looks good and is tried. A state without actions that is no goal costs infinitely much.
    (Watkins and Dayan, "Q-learning", 1992.)

    Attributes:
        exploration: epsilon, the probability of an action at random, in [0, 1].
        step_power: alpha = 1 / (visits of the action)^step_power. 0 is right where actions have one outcome each, as
            here; with random outcomes it must be in (1/2, 1].
        step_limit: actions of an episode, >= 1.

    Raises:
        BadInput: if a number is out of its range.
    """

    exploration: float = 0.1
    step_power: float = 0.0
    step_limit: int = 10_000

    def __post_init__(self) -> None:
        for name in ("exploration", "step_power"):
            number = getattr(self, name)
            if not 0.0 <= number <= 1.0:
                raise BadInput(name, str(number), "a number in [0, 1]")
        if self.step_limit < 1:
            raise BadInput("step_limit", str(self.step_limit), "an integer >= 1")

    def learn(
        self,
        graph: StateGraph,
        generator: np.random.Generator,
        *,
        episodes: int,
        anywhere: bool = False,
        values: FloatArray | None = None,
    ) -> FloatArray:
        """Action values after some episodes.

        Args:
            graph: what is acted in.
            generator: decides everything that is random.
            episodes: how many, each until a goal, a dead end or the step limit.
            anywhere: whether episodes start in any state, rather than in the first one.
            values: from earlier episodes, to go on from; not modified.

        Returns:
            Q of each transition in the units of the metric: (m,).
        """
        known = np.zeros(graph.starts.size) if values is None else values.copy()
        visits = np.zeros(graph.starts.size)
        costs, offsets = graph.costs.astype(float) * float(graph.unit), graph.offsets
        for _ in range(episodes):
            state = int(generator.integers(graph.size)) if anywhere else 0
            for _ in range(self.step_limit):
                low, high = offsets[state], offsets[state + 1]
                if low == high:
                    break
                edge = self._choose(known[low:high], generator) + int(low)
                after = int(graph.ends[edge])
                visits[edge] += 1.0
                target = costs[edge] + _least(graph, known[offsets[after] : offsets[after + 1]], after)
                known[edge] = _towards(known[edge], target, visits[edge] ** -self.step_power)
                state = after
        return known

    def _choose(self, values: FloatArray, generator: np.random.Generator) -> int:
        if generator.random() < self.exploration:
            return int(generator.integers(values.size))
        return int(np.argmin(values))


def _least(graph: StateGraph, values: FloatArray, state: int) -> float:
    if graph.goals[state]:
        return 0.0
    return float(values.min(initial=np.inf))


def _towards(value: float, target: float, step: float) -> float:
    return target if step == 1.0 or not np.isfinite(target) else value + step * (target - value)
