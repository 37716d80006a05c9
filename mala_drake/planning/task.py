"""A planning task as users handle it: load it, look at its states, apply actions."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from mala_drake.errors import BadInput
from mala_drake.planning.dominance import ResourceFinder
from mala_drake.planning.ground import Grounder
from mala_drake.planning.ground_task import GroundTask
from mala_drake.planning.interpreter import Interpreter
from mala_drake.planning.limits import Budget
from mala_drake.planning.metric import CostSplit, split_metric
from mala_drake.planning.numbers import NumberTable
from mala_drake.planning.operators import OperatorTask, compile_task
from mala_drake.planning.projection import FactGraph
from mala_drake.planning.reader import read_description
from mala_drake.planning.source import read_text
from mala_drake.planning.state import Amount, Name, SymbolicState, as_exact, as_fact
from mala_drake.planning.syntax import Description, Fact

_MOST_GROUNDINGS = 8


class Grounding:
    """A grounded task with everything that is derived from it once."""

    def __init__(self, task: GroundTask, split: CostSplit) -> None:
        self.reached = task.reached
        self.ground_task = task
        self.split = split
        self.operators: OperatorTask = compile_task(task, split)
        self.table = NumberTable(self.operators)
        self.graph = FactGraph(self.operators)
        self.resources = ResourceFinder(self.operators)


class PlanningTask:
    """A domain and a problem.

    Attributes:
        description: the lifted task.
        initial_state: the state given by `:init`.
        parse_ms: milliseconds it took to read.
    """

    def __init__(self, description: Description, *, parse_ms: float = 0.0) -> None:
        self.description = description
        self.initial_state = SymbolicState(description.facts, description.values)
        self.parse_ms = parse_ms
        self._grounder = Grounder(description)
        self._interpreter = Interpreter(description)
        self._groundings: dict[tuple[frozenset[Fact], frozenset[Fact]], Grounding] = {}

    @classmethod
    def load(cls, domain: str | Path, problem: str | Path) -> PlanningTask:
        """Reads a task from two files.

        Raises:
            BadInput: if a file cannot be read or used; says where and why in one line.
        """
        return cls.parse(read_text(domain), read_text(problem), domain_name=str(domain), problem_name=str(problem))

    @classmethod
    def parse(
        cls, domain: str, problem: str, *, domain_name: str = "domain", problem_name: str = "problem"
    ) -> PlanningTask:
        """Reads a task from two texts, named `domain_name` and `problem_name` in messages.

        Raises:
            BadInput: if a text cannot be used.
        """
        started = time.perf_counter()
        description = read_description(domain, problem, domain_name=domain_name, problem_name=problem_name)
        return cls(description, parse_ms=1e3 * (time.perf_counter() - started))

    def with_weights(
        self,
        state: SymbolicState,
        weights: Mapping[str, Amount] | Sequence[Amount] | None = None,
        fluents: Mapping[Name, Amount] | None = None,
    ) -> SymbolicState:
        """The state with other weights and fluents.

        Args:
            state: the state to change.
            weights: values of the fluents `(w0)`, `(w1)`, ... in order, or by name.
            fluents: values of any fluents.

        Raises:
            BadInput: if the domain has no such fluent or a value is not a finite number.
        """
        if weights is None and not fluents:
            return state
        given: dict[Fact, Fraction] = {}
        if weights is not None:
            named = weights if isinstance(weights, Mapping) else {f"w{i}": each for i, each in enumerate(weights)}
            given = {as_fact(name): as_exact(value, where=f"weights: {name}") for name, value in named.items()}
        given |= {as_fact(name): as_exact(value, where=str(name)) for name, value in (fluents or {}).items()}
        self._check_names(given, self.description.functions, "fluent")
        return SymbolicState(state.facts, {**state.values, **given})

    def holds(self, state: SymbolicState, fact: Name) -> bool:
        """Whether a fact is true in a state."""
        return state.holds(fact)

    def is_goal(self, state: SymbolicState) -> bool:
        """Whether the goal is true in a state."""
        return self._interpreter.is_goal(state)

    def apply(self, state: SymbolicState, action: str) -> SymbolicState:
        """The state after an action such as `(drive truck1 a b)`.

        Raises:
            BadInput: if there is no such action.
            ValueError: if it is not applicable in `state`.
        """
        return self._interpreter.apply(state, action)

    def applicable(self, state: SymbolicState) -> tuple[str, ...]:
        """The actions that are applicable in a state, by name."""
        actions = self.grounding(state).ground_task.actions
        return tuple(each.name for each in actions if self._interpreter.is_applicable(state, each.name))

    def metric_value(self, state: SymbolicState) -> Fraction | None:
        """The metric in a state; None if there is no metric or it is undefined there."""
        return self._interpreter.metric_value(state)

    def grounding(self, state: SymbolicState, budget: Budget | None = None) -> Grounding:
        """A grounding that covers everything `state` can lead to, an earlier one where possible.

        Raises:
            BadInput: if the state names what the task does not have.
            OutOfBudget: if the time is up.
        """
        grounder = self._grounder
        static = frozenset(fact for fact in state.facts if fact[0] not in grounder.changing_predicates)
        key = (static, frozenset(state.values))
        known = self._groundings.get(key)
        changing = state.facts - static
        if known is not None and changing <= known.reached:
            self._groundings[key] = self._groundings.pop(key)  # The least recently used one is the first to go.
            return known
        self._check_names(state.facts, self.description.predicates, "fact")
        self._check_names(state.values, self.description.functions, "fluent")
        seed = state.facts | (known.reached if known is not None else frozenset())
        defined = [each for each in state.values if each[0] not in grounder.changing_functions]
        tick = (budget or Budget()).tick
        ground_task = grounder.ground(seed, defined, tick)
        metric = self.description.metric
        polynomial = None
        if metric is not None:
            polynomial = grounder.polynomial(metric.expression)
            polynomial = polynomial if metric.minimize else polynomial.times(-1)
        grounding = Grounding(ground_task, split_metric(ground_task, polynomial, frozenset(state.values)))
        while len(self._groundings) >= _MOST_GROUNDINGS:
            del self._groundings[next(iter(self._groundings))]
        self._groundings[key] = grounding
        return grounding

    def _check_names(
        self, names: Iterable[Fact], declared: Mapping[str, tuple[tuple[str, ...], ...]], kind: str
    ) -> None:
        for name in names:
            text = f"({' '.join(name)})"
            signature = declared.get(name[0]) if name else None
            if signature is None or len(signature) != len(name) - 1:
                known = f"one of {' '.join(sorted(declared))}" if declared else f"no {kind}: it declares none"
                raise BadInput(text, f"the domain has no such {kind}", known)
            for each in name[1:]:
                if each not in self.description.objects:
                    raise BadInput(text, f"the task has no object '{each}'")
