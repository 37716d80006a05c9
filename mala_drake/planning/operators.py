"""Ground actions as bit masks and numbered fluents: the form that search works on, the same for all numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from mala_drake.planning import ground_task
from mala_drake.planning.ground_task import GroundTask
from mala_drake.planning.metric import ZERO, CostSplit
from mala_drake.planning.polynomial import Polynomial
from mala_drake.planning.syntax import Fact


@dataclass(frozen=True, slots=True)
class Comparison:
    """Polynomial number `polynomial`, compared with zero."""

    polynomial: int
    operator: str


@dataclass(frozen=True, slots=True)
class Condition:
    """A `ground_task.Condition` whose facts are bits."""

    positive: int
    negative: int
    comparisons: tuple[Comparison, ...]
    choices: tuple[tuple[Condition, ...], ...]

    @property
    def reads_numbers(self) -> bool:
        """Whether a comparison takes part."""
        return bool(self.comparisons) or any(part.reads_numbers for choice in self.choices for part in choice)


@dataclass(frozen=True, slots=True)
class Update:
    """A numeric effect on fluent number `fluent` by polynomial number `value`."""

    fluent: int
    kind: str
    value: int


@dataclass(frozen=True, slots=True)
class Effect:
    """What happens under `condition`; `cost` is the number of the polynomial it adds to the cost, None for nothing."""

    condition: Condition
    added: int
    deleted: int
    updates: tuple[Update, ...]
    cost: int | None


@dataclass(frozen=True, slots=True)
class Operator:
    """A ground action. `always` is the effect without a condition; `sometimes` are the conditional ones."""

    index: int
    name: str
    precondition: Condition
    always: Effect
    sometimes: tuple[Effect, ...]


@dataclass(slots=True)
class OperatorTask:
    """A ground task as operators, with the tables that lead back to names.

    `facts` are the bits, lowest first, and only such facts as some condition reads; `fluents` the numeric fluents that
    stay in the state; `polynomials` every expression; `rest` the part of the cost that is a function of the state;
    `step_costs` the different costs of operators, as the polynomial that always counts and those that may.
    """

    operators: tuple[Operator, ...]
    goal: Condition | None
    facts: Mapping[Fact, int]
    fluents: Mapping[Fact, int]
    polynomials: tuple[Polynomial, ...]
    rest: int | None
    step_costs: tuple[tuple[int | None, tuple[int, ...]], ...] = ()
    _candidates: dict[int, tuple[Operator, ...]] = field(default_factory=dict)
    _buckets: list[tuple[int, tuple[Operator, ...]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._buckets = _bucket(self.operators)
        costs = (
            (each.always.cost, tuple(effect.cost for effect in each.sometimes if effect.cost is not None))
            for each in self.operators
        )
        self.step_costs = tuple(dict.fromkeys(costs))

    def candidates(self, mask: int) -> tuple[Operator, ...]:
        """The operators whose precondition's masks fit the facts `mask`, by name."""
        found = self._candidates.get(mask)
        if found is None:
            fitting = [
                operator
                for bit, operators in self._buckets
                if mask & bit == bit
                for operator in operators
                if mask & operator.precondition.positive == operator.precondition.positive
                and not mask & operator.precondition.negative
            ]
            found = tuple(sorted(fitting, key=lambda operator: operator.index))
            if len(self._candidates) < 200_000:
                self._candidates[mask] = found
        return found

    def mask(self, facts: Iterable[Fact]) -> int:
        """The facts that matter, as bits."""
        bits = self.facts
        mask = 0
        for fact in facts:
            bit = bits.get(fact)
            if bit is not None:
                mask |= 1 << bit
        return mask


def compile_task(task: GroundTask, split: CostSplit) -> OperatorTask:
    """Numbers the facts, fluents and polynomials of a ground task.

    Args:
        task: the ground task.
        split: its cost.
    """
    compiler = _Compiler(split)
    goal = None if task.goal is None else compiler.condition(task.goal)
    conditions = [
        (compiler.condition(action.precondition), [compiler.condition(each.condition) for each in action.effects])
        for action in task.actions
    ]
    operators = [compiler.operator(index, action, *conditions[index]) for index, action in enumerate(task.actions)]
    rest = compiler.number(split.rest) if split.rest.fluents() else None
    for polynomial in tuple(compiler.polynomials):
        for fluent in sorted(polynomial.fluents()):
            compiler.fluent(fluent)
    return OperatorTask(tuple(operators), goal, compiler.facts, compiler.fluents, tuple(compiler.polynomials), rest)


class _Compiler:
    def __init__(self, split: CostSplit) -> None:
        self._split = split
        self.facts: dict[Fact, int] = {}
        self.fluents: dict[Fact, int] = {}
        self.polynomials: dict[Polynomial, int] = {}

    def condition(self, condition: ground_task.Condition) -> Condition:
        choices = tuple(tuple(self.condition(part) for part in choice) for choice in condition.choices)
        comparisons = tuple(Comparison(self.number(each.polynomial), each.operator) for each in condition.comparisons)
        return Condition(self._bits(condition.positive), self._bits(condition.negative), comparisons, choices)

    def operator(
        self, index: int, action: ground_task.GroundAction, precondition: Condition, guards: list[Condition]
    ) -> Operator:
        always = Effect(_NOTHING, 0, 0, (), self._cost(self._split.step))
        sometimes = []
        for effect, guard in zip(action.effects, guards, strict=True):
            if effect.condition == ground_task.TRUE:
                always = self._effect(effect, guard, self._split.step)
            else:
                sometimes.append(self._effect(effect, guard, ZERO))
        return Operator(index, action.name, precondition, always, tuple(sometimes))

    def _effect(self, effect: ground_task.Effect, guard: Condition, base: Polynomial) -> Effect:
        split = self._split
        kept = [each for each in effect.updates if each.fluent not in split.weights]
        updates = tuple(Update(self.fluent(each.fluent), each.kind, self.number(each.value)) for each in kept)
        cost = base + split.increment(effect.updates)
        added = self._known_bits(effect.added)
        return Effect(guard, added, self._known_bits(effect.deleted) & ~added, updates, self._cost(cost))

    def _cost(self, polynomial: Polynomial) -> int | None:
        return self.number(polynomial) if polynomial.terms else None

    def number(self, polynomial: Polynomial) -> int:
        return self.polynomials.setdefault(polynomial, len(self.polynomials))

    def fluent(self, fluent: Fact) -> int:
        return self.fluents.setdefault(fluent, len(self.fluents))

    def _bits(self, facts: Iterable[Fact]) -> int:
        mask = 0
        for fact in sorted(facts):
            mask |= 1 << self.facts.setdefault(fact, len(self.facts))
        return mask

    def _known_bits(self, facts: Iterable[Fact]) -> int:
        # A fact that no condition reads has no bit: states that differ in it alone are the same.
        return sum(1 << self.facts[fact] for fact in facts if fact in self.facts)


_NOTHING = Condition(0, 0, (), ())


def _bucket(operators: tuple[Operator, ...]) -> list[tuple[int, tuple[Operator, ...]]]:
    """Operators by the rarest fact they need, so that most of them are never looked at."""
    uses: dict[int, int] = {}
    for operator in operators:
        for bit in _single_bits(operator.precondition.positive):
            uses[bit] = uses.get(bit, 0) + 1
    buckets: dict[int, list[Operator]] = {}
    for operator in operators:
        bits = _single_bits(operator.precondition.positive)
        # Among equally rare facts the lowest bit, so that the order is the same in every run.
        key = min(bits, key=lambda bit: (uses[bit], bit), default=0)
        buckets.setdefault(key, []).append(operator)
    return [(bit, tuple(buckets[bit])) for bit in sorted(buckets)]


def _single_bits(mask: int) -> list[int]:
    bits = []
    while mask:
        bits.append(mask & -mask)
        mask &= mask - 1
    return bits
