"""Optimal planning: from a task, a state and weights to a plan."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Literal

from mala_drake.errors import BadInput
from mala_drake.planning.bounds import never_gains
from mala_drake.planning.dominance import ResourceDominance
from mala_drake.planning.exhaustive import UnboundedError, exhaustive
from mala_drake.planning.landmark_cut import LandmarkCut
from mala_drake.planning.limits import Budget, OutOfBudget
from mala_drake.planning.model import Model, State
from mala_drake.planning.plan import Plan
from mala_drake.planning.polynomial import evaluate
from mala_drake.planning.projection import ProjectionHeuristic
from mala_drake.planning.search import Dominated, Heuristic, Solution, best_first, no_dominance
from mala_drake.planning.state import Amount, Name, SymbolicState
from mala_drake.planning.task import Grounding, PlanningTask

SearchName = Literal["astar", "ucs"]
_SEARCHES = ("astar", "ucs")
_MOST_EXPANSIONS = 1_000_000  # Unless the caller sets a limit: with numbers there may be infinitely many states.


class Planner:
    """Finds optimal plans for one task, again and again with other states and weights.

    Args:
        task: the task.
        search: `astar`, or `ucs` for blind uniform-cost search, which is slow and serves as the truth to compare with.
    """

    def __init__(self, task: PlanningTask, search: SearchName = "astar") -> None:
        if search not in _SEARCHES:
            raise BadInput("search", f"unknown search {search!r}", f"one of {', '.join(_SEARCHES)}")
        self.task = task
        self._search = search

    def solve(
        self,
        state: SymbolicState | None = None,
        weights: Mapping[str, Amount] | Sequence[Amount] | None = None,
        *,
        fluents: Mapping[Name, Amount] | None = None,
        max_expansions: int | None = None,
        timeout: float | None = None,
    ) -> Plan:
        """An optimal plan from `state` (by default the initial state) to the goal.

        Args:
            state: where to start.
            weights: values of the fluents `(w0)`, `(w1)`, ... in order, or by name.
            fluents: values of any other fluents, such as learned ones.
            max_expansions: give up after this many expansions; the same on every machine. A million if no limit is
                given at all, for with numbers there may be infinitely many states.
            timeout: give up after this many seconds of wall time.

        Raises:
            BadInput: if the state, weights or fluents name what the task does not have.
        """
        started = time.perf_counter()
        if max_expansions is None and timeout is None:
            max_expansions = _MOST_EXPANSIONS
        budget = Budget(max_expansions=max_expansions, timeout=timeout)
        start = self.task.with_weights(state or self.task.initial_state, weights, fluents)
        grounded = started
        try:
            grounding = self.task.grounding(start, budget)
            grounded = time.perf_counter()
            status, cost, actions = self._solve(grounding, start, budget)
        except OutOfBudget:
            status, cost, actions = "timeout", None, ()
        return Plan(
            status=status,  # type: ignore[arg-type]
            cost=cost,
            actions=actions,
            expanded=budget.expanded,
            search_ms=1e3 * (time.perf_counter() - grounded),
            parse_ms=self.task.parse_ms,
            ground_ms=1e3 * (grounded - started),
        )

    def _solve(
        self, grounding: Grounding, state: SymbolicState, budget: Budget
    ) -> tuple[str, Fraction | None, tuple[str, ...]]:
        if grounding.operators.goal is None:
            return "unsolvable", None, ()
        model = Model(grounding.operators, grounding.table, state.values)
        initial_cost = self._initial_cost(grounding, state)
        start = (grounding.operators.mask(state.facts), model.numbers.initial())
        if not never_gains(model, state.values):
            solution = self._visit_all(model, start, budget)
        elif self._search == "ucs":
            solution = best_first(model, start, budget=budget)
        else:
            solution = self._a_star(grounding, model, start, budget)
        if solution is None:
            return "unsolvable", None, ()
        cost = initial_cost + model.numbers.exact(solution.cost)
        metric = self.task.description.metric
        if metric is not None and not metric.minimize:
            cost = -cost
        return "optimal", cost, tuple(operator.name for operator in solution.operators)

    @staticmethod
    def _a_star(grounding: Grounding, model: Model, start: State, budget: Budget) -> Solution | None:
        heuristic: Heuristic
        if grounding.graph.explore(start[0], budget):
            heuristic = ProjectionHeuristic(grounding.graph, model)
        else:
            heuristic = LandmarkCut(model, budget.tick)
        directions = grounding.resources.find(model, start)
        dominated: Dominated = ResourceDominance(directions, len(start[1])) if directions else no_dominance
        return best_first(model, start, heuristic=heuristic, dominated=dominated, budget=budget)

    def _visit_all(self, model: Model, start: State, budget: Budget) -> Solution | None:
        try:
            return exhaustive(model, start, budget=budget)
        except UnboundedError:
            raise BadInput(
                f"problem {self.task.description.problem_name}: :metric",
                "improves without end, no plan is optimal",
                "a metric with a bound",
            ) from None

    def _initial_cost(self, grounding: Grounding, state: SymbolicState) -> Fraction:
        """The metric at the start, without the rest of it if that is a function of the state not defined there."""
        split = grounding.split
        total = evaluate(split.rest, state.values)
        if total is None and split.rest.fluents():
            total = Fraction(0)
        for fluent, weight in split.weights.items():
            factor = evaluate(weight, state.values)
            total = None if total is None or factor is None else total + factor * state.values[fluent]
        if total is None:
            where = f"problem {self.task.description.problem_name}: :metric"
            raise BadInput(where, "is undefined for every plan", "values in :init for what it reads")
        return total
