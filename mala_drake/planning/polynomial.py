"""Exact polynomials over numeric fluents: the normal form of every expression of a ground task.

A monomial is a sorted tuple of atoms; an atom is `("static", fluent)`, `("fluent", fluent)` or `("inverse",
polynomial)` for one over a polynomial. A monomial whose coefficient is zero stays: what it reads must still be defined
for the expression to be defined.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mala_drake.planning.syntax import Arithmetic, Expression, Fact, Fluent

STATIC, FLUENT, INVERSE = "static", "fluent", "inverse"

Atom = tuple[str, Any]
Monomial = tuple[Atom, ...]


@dataclass(frozen=True, slots=True)
class Polynomial:
    """A sum of coefficients times monomials, sorted, so that equal sums are equal objects."""

    terms: tuple[tuple[Monomial, Fraction], ...]

    def __add__(self, other: Polynomial) -> Polynomial:
        sums = dict(self.terms)
        for monomial, coefficient in other.terms:
            sums[monomial] = sums.get(monomial, Fraction(0)) + coefficient
        return _collect(sums)

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + other.times(-1)

    def __mul__(self, other: Polynomial) -> Polynomial:
        sums: dict[Monomial, Fraction] = {}
        for left, left_coefficient in self.terms:
            for right, right_coefficient in other.terms:
                monomial = tuple(sorted(left + right, key=_order))
                sums[monomial] = sums.get(monomial, Fraction(0)) + left_coefficient * right_coefficient
        return _collect(sums)

    def times(self, factor: Fraction | int) -> Polynomial:
        """The polynomial times a number."""
        return Polynomial(tuple((monomial, coefficient * factor) for monomial, coefficient in self.terms))

    def inverse(self) -> Polynomial:
        """One over the polynomial."""
        if not self.atoms() and self.constant:
            return constant(1 / self.constant)
        return Polynomial(((((INVERSE, self),), Fraction(1)),))

    @property
    def constant(self) -> Fraction:
        """The coefficient of the empty monomial."""
        return self.terms[0][1] if self.terms and not self.terms[0][0] else Fraction(0)

    def atoms(self) -> Iterator[Atom]:
        """Every atom, those inside inverses too, in no particular number of times."""
        for monomial, _ in self.terms:
            for atom in monomial:
                yield atom
                if atom[0] == INVERSE:
                    yield from atom[1].atoms()

    def fluents(self) -> frozenset[Fact]:
        """The changing fluents it reads."""
        return frozenset(name for kind, name in self.atoms() if kind == FLUENT)

    def statics(self) -> frozenset[Fact]:
        """The fluents it reads that no action changes."""
        return frozenset(name for kind, name in self.atoms() if kind == STATIC)


def constant(value: Fraction | int) -> Polynomial:
    """A number as a polynomial."""
    return Polynomial((((), Fraction(value)),))


def variable(fluent: Fact, *, static: bool) -> Polynomial:
    """A fluent as a polynomial."""
    return Polynomial(((((STATIC if static else FLUENT, fluent),), Fraction(1)),))


def is_static(atom: Atom) -> bool:
    """Whether an atom's value does not depend on the state."""
    return atom[0] == STATIC or (atom[0] == INVERSE and not atom[1].fluents())


def expand(expression: Expression, ground: Callable[[Fluent], Polynomial]) -> Polynomial:
    """The normal form of an expression; `ground` gives each fluent its polynomial."""
    if isinstance(expression, Fluent):
        return ground(expression)
    if not isinstance(expression, Arithmetic):
        return constant(expression)
    first, *rest = (expand(operand, ground) for operand in expression.operands)
    if expression.operator == "-" and not rest:
        return first.times(-1)
    for operand in rest:
        if expression.operator == "+":
            first = first + operand
        elif expression.operator == "-":
            first = first - operand
        elif expression.operator == "*":
            first = first * operand
        else:
            first = first * operand.inverse()
    return first


def evaluate(polynomial: Polynomial, values: Mapping[Fact, Fraction]) -> Fraction | None:
    """The value of a polynomial, None if it reads what has no value or divides by zero."""
    total = Fraction(0)
    for monomial, coefficient in polynomial.terms:
        product = coefficient
        for kind, content in monomial:
            if kind == INVERSE:
                below = evaluate(content, values)
                factor = 1 / below if below else None
            else:
                factor = values.get(content)
            if factor is None:
                return None
            product *= factor
        total += product
    return total


def _collect(sums: dict[Monomial, Fraction]) -> Polynomial:
    return Polynomial(tuple(sorted(sums.items(), key=lambda item: (len(item[0]), list(map(_order, item[0]))))))


def _order(atom: Atom) -> tuple[str, str]:
    return atom[0], repr(atom[1])
