"""A symbolic state: the facts that are true and the values of the numeric fluents."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType

from mala_drake.errors import BadInput
from mala_drake.planning.syntax import Fact

DECIMALS = 6  # Floats are rounded to this many decimals: what is measured is never more exact than that.

Name = str | Iterable[str]  # `("at", "robot1", "home")` or `"(at robot1 home)"`.
Amount = int | float | Decimal | Fraction


@dataclass(frozen=True, slots=True)
class SymbolicState:
    """A state of a planning task, by names, independent of any planner; immutable, so that it can be a message.

    Attributes:
        facts: the true atoms, each a tuple of the predicate and its objects.
        values: the numeric fluents that have a value, exactly.
    """

    facts: frozenset[Fact]
    values: Mapping[Fact, Fraction]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def __hash__(self) -> int:
        return hash((self.facts, frozenset(self.values.items())))

    def __deepcopy__(self, memo: dict[int, object]) -> SymbolicState:
        return self

    def __reduce__(self) -> tuple[type, tuple[frozenset[Fact], dict[Fact, Fraction]]]:
        return type(self), (self.facts, dict(self.values))

    def holds(self, fact: Name) -> bool:
        """Whether a fact is true."""
        return as_fact(fact) in self.facts

    def value(self, fluent: Name) -> Fraction | None:
        """The value of a numeric fluent, None if it has none."""
        return self.values.get(as_fact(fluent))

    def with_facts(self, add: Iterable[Name] = (), remove: Iterable[Name] = ()) -> SymbolicState:
        """The state with some facts made false, then others made true."""
        removed = {as_fact(fact) for fact in remove}
        return SymbolicState((self.facts - removed) | {as_fact(fact) for fact in add}, self.values)

    def with_fluents(self, values: Mapping[Name, Amount]) -> SymbolicState:
        """The state with other values of some fluents.

        Integers, fractions and decimals are taken exactly, floats rounded to `DECIMALS` decimals.

        Raises:
            BadInput: if a value is not a finite number.
        """
        changed = {as_fact(name): as_exact(value, where=str(name)) for name, value in values.items()}
        return SymbolicState(self.facts, {**self.values, **changed})


def as_fact(name: Name) -> Fact:
    """A fact or fluent given as `"(at robot1 home)"`, `"w0"` or a sequence of names, in lower case."""
    words = name.strip().removeprefix("(").removesuffix(")").split() if isinstance(name, str) else name
    return tuple(word.lower() for word in words)


def as_exact(value: Amount, *, where: str) -> Fraction:
    """A number as a fraction, a float rounded to `DECIMALS` decimals.

    Raises:
        BadInput: if it is not a finite number.
    """
    if isinstance(value, int | Fraction) and not isinstance(value, bool):
        return Fraction(value)
    if isinstance(value, Decimal) and value.is_finite():
        return Fraction(value)
    if not isinstance(value, Decimal | str | bool | int | Fraction):
        number = float(value)
        if math.isfinite(number):
            scaled = number * 10**DECIMALS
            # Where that is beyond all floats, the number is so large that it is whole.
            return Fraction(round(scaled), 10**DECIMALS) if math.isfinite(scaled) else Fraction(number)
    raise BadInput(where, f"value {value}", "a finite number")
