"""What a grounded task is made of: actions and conditions without parameters and quantifiers, and their logic."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from mala_drake.planning.polynomial import Polynomial
from mala_drake.planning.syntax import Fact


@dataclass(frozen=True, slots=True)
class Comparison:
    """`polynomial operator 0`, operator one of > >= = !=; false where the polynomial is undefined."""

    polynomial: Polynomial
    operator: str


@dataclass(frozen=True, slots=True)
class Condition:
    """A conjunction of literals, comparisons and, in `choices`, disjunctions of conditions."""

    positive: frozenset[Fact] = frozenset()
    negative: frozenset[Fact] = frozenset()
    comparisons: tuple[Comparison, ...] = ()
    choices: tuple[tuple[Condition, ...], ...] = ()

    def parts(self) -> Iterator[Condition]:
        """Itself and every condition inside it."""
        yield self
        for choice in self.choices:
            for part in choice:
                yield from part.parts()


TRUE = Condition()


@dataclass(frozen=True, slots=True)
class Update:
    """A numeric effect: `add` the value to the fluent, `scale` the fluent by it, or `set` the fluent to it."""

    fluent: Fact
    kind: str
    value: Polynomial


@dataclass(frozen=True, slots=True)
class Effect:
    """What happens together when `condition` held before the action; deletions come before additions."""

    condition: Condition
    added: frozenset[Fact]
    deleted: frozenset[Fact]
    updates: tuple[Update, ...]


@dataclass(frozen=True, slots=True)
class GroundAction:
    """An action with its objects, `name` as in a plan: `(drive truck1 a b)`."""

    name: str
    precondition: Condition
    effects: tuple[Effect, ...]


@dataclass(frozen=True, slots=True)
class GroundTask:
    """All actions that are relaxed reachable from `reached`'s seed, sorted by name; `goal` is None if never true."""

    actions: tuple[GroundAction, ...]
    goal: Condition | None
    reached: frozenset[Fact]


def conjunction(parts: Iterable[Condition | None]) -> Condition | None:
    """All of `parts`; None, which is false, if one is or two contradict each other."""
    positive: frozenset[Fact] = frozenset()
    negative: frozenset[Fact] = frozenset()
    comparisons: dict[Comparison, None] = {}
    choices: dict[tuple[Condition, ...], None] = {}
    for part in parts:
        if part is None:
            return None
        positive |= part.positive
        negative |= part.negative
        comparisons.update(dict.fromkeys(part.comparisons))
        choices.update(dict.fromkeys(part.choices))
    return None if positive & negative else Condition(positive, negative, tuple(comparisons), tuple(choices))


def disjunction(parts: Iterable[Condition | None]) -> Condition | None:
    """Any of `parts`; None, which is false, if there is none."""
    possible = tuple(dict.fromkeys(part for part in parts if part is not None))
    if TRUE in possible:
        return TRUE
    if len(possible) <= 1:
        return possible[0] if possible else None
    return Condition(choices=(possible,))


def merged(effects: Iterable[Effect]) -> tuple[Effect, ...]:
    """Effects with the same condition as one."""
    merged: dict[Condition, Effect] = {}
    for effect in effects:
        same = merged.get(effect.condition)
        merged[effect.condition] = (
            effect
            if same is None
            else Effect(
                effect.condition,
                same.added | effect.added,
                same.deleted | effect.deleted,
                same.updates + effect.updates,
            )
        )
    return tuple(merged.values())
