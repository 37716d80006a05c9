"""The lifted planning task: what the files say, with every name resolved, before any variable is bound.

Terms are plain strings: `?name` is a variable, anything else an object.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

Fact = tuple[str, ...]  # A ground atom or fluent: its name, then its objects.


@dataclass(frozen=True, slots=True)
class Parameter:
    """A typed variable; an object of any one of `types` may take its place."""

    name: str
    types: tuple[str, ...]


# Conditions.


@dataclass(frozen=True, slots=True)
class Atom:
    """`(predicate term ...)`."""

    predicate: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Same:
    """`(= left right)` between objects."""

    left: str
    right: str


@dataclass(frozen=True, slots=True)
class Not:
    """Negation."""

    part: Condition


@dataclass(frozen=True, slots=True)
class And:
    """Conjunction; true when empty."""

    parts: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """Disjunction; false when empty."""

    parts: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class ForAll:
    """`(forall (variables) part)`."""

    variables: tuple[Parameter, ...]
    part: Condition


@dataclass(frozen=True, slots=True)
class Exists:
    """`(exists (variables) part)`."""

    variables: tuple[Parameter, ...]
    part: Condition


@dataclass(frozen=True, slots=True)
class Comparison:
    """`(operator left right)` between numbers, operator one of > >= = <= <."""

    operator: str
    left: Expression
    right: Expression


Condition = Atom | Same | Not | And | Or | ForAll | Exists | Comparison

# Numeric expressions.


@dataclass(frozen=True, slots=True)
class Fluent:
    """The value of a numeric fluent, `(name term ...)`."""

    name: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """`(operator operand ...)`, operator one of + - * /; a single operand of `-` is negated."""

    operator: str
    operands: tuple[Expression, ...]


Expression = Fraction | Fluent | Arithmetic

# Effects.


@dataclass(frozen=True, slots=True)
class SetFact:
    """Makes an atom true or false."""

    atom: Atom
    value: bool


@dataclass(frozen=True, slots=True)
class SetFluent:
    """`(operator fluent expression)`, operator one of assign, increase, decrease, scale-up, scale-down."""

    operator: str
    fluent: Fluent
    expression: Expression


@dataclass(frozen=True, slots=True)
class When:
    """Effects that happen only if `condition` held before the action."""

    condition: Condition
    effects: tuple[Effect, ...]


@dataclass(frozen=True, slots=True)
class ForEach:
    """Effects repeated for every binding of `variables`."""

    variables: tuple[Parameter, ...]
    effects: tuple[Effect, ...]


Effect = SetFact | SetFluent | When | ForEach


@dataclass(frozen=True, slots=True)
class ActionSchema:
    """An action with its parameters unbound."""

    name: str
    parameters: tuple[Parameter, ...]
    precondition: Condition
    effects: tuple[Effect, ...]


@dataclass(frozen=True, slots=True)
class Metric:
    """What a plan is measured by: minimise `expression` in the final state, or maximise it."""

    minimize: bool
    expression: Expression


@dataclass(frozen=True, slots=True)
class Description:
    """A domain and a problem together.

    `objects` maps each object, constants included, to its type; `parents` each type to its supertype (`object` to
    the empty string); `predicates` and `functions` each symbol to the alternatives of types of its arguments.
    """

    domain_name: str
    problem_name: str
    parents: Mapping[str, str]
    objects: Mapping[str, str]
    predicates: Mapping[str, tuple[tuple[str, ...], ...]]
    functions: Mapping[str, tuple[tuple[str, ...], ...]]
    actions: tuple[ActionSchema, ...]
    facts: frozenset[Fact]
    values: Mapping[Fact, Fraction]
    goal: Condition
    metric: Metric | None

    def is_subtype(self, name: str, ancestor: str) -> bool:
        """Whether type `name` is `ancestor` or below it."""
        while name and name != ancestor:
            name = self.parents[name]
        return name == ancestor

    def objects_of(self, types: tuple[str, ...]) -> tuple[str, ...]:
        """The objects that belong to any of `types`, sorted by name."""
        return tuple(
            sorted(name for name, kind in self.objects.items() if any(self.is_subtype(kind, each) for each in types))
        )
