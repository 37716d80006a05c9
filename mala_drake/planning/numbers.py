"""The numbers of one solve: polynomials with the current constants filled in.

Most tasks only add or assign constants and compare linearly (`is_stepwise`). There all numbers are integers, multiples
of one common unit, which is exact and three times faster than fractions; everything else is computed in fractions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from mala_drake.planning.operators import Comparison, OperatorTask
from mala_drake.planning.polynomial import FLUENT, STATIC, Monomial, Polynomial, is_static
from mala_drake.planning.state import DECIMALS
from mala_drake.planning.syntax import Fact

Number = int | Fraction
Values = tuple[Number | None, ...]  # Of the fluents in the state, in the order of their numbers; None is undefined.

_LARGEST_UNIT = 10**60  # A finer unit means integers slower than fractions.


@dataclass(frozen=True, slots=True)
class _Term:
    """One monomial of the state's fluents and the static factors in front of it."""

    changing: Monomial
    factors: tuple[tuple[Fraction, Monomial], ...]


# A polynomial with the constants filled in: what is constant, then factor, fluents and inverses of each other monomial.
_Filled = tuple[Number, tuple[tuple[Number, tuple[int, ...], Monomial], ...]]


class NumberTable:
    """What can be prepared about a task's polynomials before the constants are known."""

    def __init__(self, task: OperatorTask) -> None:
        self.task = task
        self.terms = tuple(_group(polynomial) for polynomial in task.polynomials)
        self.statics = tuple(sorted({name for polynomial in task.polynomials for name in polynomial.statics()}))
        self.is_stepwise = self._steps_only()
        coefficients = [number for polynomial in task.polynomials for _, number in polynomial.terms]
        self.denominator = math.lcm(*(number.denominator for number in coefficients))
        factors = [monomial for terms in self.terms for term in terms for _, monomial in term.factors]
        self.degree = max((len(monomial) for monomial in factors), default=0)
        self.has_static_inverses = any(kind != STATIC for monomial in factors for kind, _ in monomial)
        self._readers: dict[Fact, list[int]] = {}
        for index, polynomial in enumerate(task.polynomials):
            for name in polynomial.statics():
                self._readers.setdefault(name, []).append(index)
        self._last: tuple[int, tuple[Fraction | None, ...], dict[int, _Filled | None]] = (-1, (), {})

    def _steps_only(self) -> bool:
        constants: set[int] = set()
        for operator in self.task.operators:
            for effect in (operator.always, *operator.sometimes):
                if any(update.kind == "scale" for update in effect.updates):
                    return False
                constants.update(update.value for update in effect.updates)
                constants.update(() if effect.cost is None else (effect.cost,))
        if self.task.rest is not None or any(not _is_linear(terms) for terms in self.terms):
            return False
        return all(not term.changing for index in constants for term in self.terms[index])

    def remembered(self, unit: int, values: Mapping[Fact, Fraction]) -> dict[int, _Filled | None]:
        """The polynomials of the last solve that read none of the constants that changed since.

        The dictionary returned is the one that the next call looks at, so that what is added to it is kept.
        """
        current = tuple(map(values.get, self.statics))
        last_unit, last, filled = self._last
        if unit != last_unit:
            filled = {}
        else:
            changed = [
                name
                for name, old, new in zip(self.statics, last, current, strict=True)
                if old is not new and old != new
            ]
            stale = {index for name in changed for index in self._readers[name]}
            filled = {index: value for index, value in filled.items() if index not in stale}
        self._last = (unit, current, filled)
        return filled


class Numbers:
    """Evaluates polynomials and comparisons in states.

    Args:
        table: the prepared polynomials.
        values: every fluent that has a value, static or not.
    """

    def __init__(self, table: NumberTable, values: Mapping[Fact, Fraction]) -> None:
        self._table = table
        self._values = values
        self._index = table.task.fluents
        self._unit = 1  # One stands for this many in the integers of a stepwise task.
        self._grid = 1
        self._scaled: dict[Fact, int] = {}
        self.is_stepwise = table.is_stepwise and not table.has_static_inverses
        if self.is_stepwise:
            self._choose_unit()
        self._filled = table.remembered(self._unit if self.is_stepwise else 0, values)

    def _choose_unit(self) -> None:
        known = {name: self._values[name] for name in self._table.statics if name in self._values}
        # Including the grid of rounded floats keeps the unit the same from one solve to the next.
        self._grid = math.lcm(10**DECIMALS, *(value.denominator for value in known.values()))
        stepped = [self._values[name].denominator for name in self._index if name in self._values]
        unit = math.lcm(self._table.denominator * self._grid**self._table.degree, *stepped)
        self.is_stepwise = unit <= _LARGEST_UNIT
        if self.is_stepwise:
            self._unit = unit
            self._scaled = {name: value.numerator * (self._grid // value.denominator) for name, value in known.items()}

    def initial(self) -> Values:
        """The values of the state's fluents."""
        found = (self._values.get(name) for name in self._index)
        return tuple(None if value is None else _tidy(value * self._unit) for value in found)

    def exact(self, number: Number) -> Fraction:
        """A number of this solve in the units of the files."""
        return Fraction(number) / self._unit

    def value(self, polynomial: int, values: Values) -> Number | None:
        """The polynomial's value, None if undefined."""
        compiled = self._filled[polynomial] if polynomial in self._filled else self._compile(polynomial)
        if compiled is None:
            return None
        total, terms = compiled
        if not terms:
            return total
        for factor, fluents, others in terms:
            product = factor
            for fluent in fluents:
                value = values[fluent]
                if value is None:
                    return None
                product = product * value
            for atom in others:
                below = self._inverse(atom[1], values)
                if below is None:
                    return None
                product = product * below
            total = total + product
        return total if type(total) is int else _tidy(Fraction(total))

    def holds(self, comparison: Comparison, values: Values) -> bool:
        """Whether a comparison is true; it is false where its polynomial is undefined."""
        value = self.value(comparison.polynomial, values)
        if value is None:
            return False
        match comparison.operator:
            case ">=":
                return value >= 0
            case ">":
                return value > 0
            case "=":
                return value == 0
        return value != 0

    def constant(self, polynomial: int) -> Number | None:
        """The value of a polynomial that reads no changing fluent; None if it reads one or is undefined."""
        compiled = self._filled[polynomial] if polynomial in self._filled else self._compile(polynomial)
        return None if compiled is None or compiled[1] else compiled[0]

    def linear(self, polynomial: int) -> tuple[Number, dict[int, Number]] | None:
        """Constant and coefficients by fluent number of a linear polynomial; None if undefined or not linear."""
        compiled = self._compile(polynomial)
        if compiled is None or any(len(fluents) != 1 or others for _, fluents, others in compiled[1]):
            return None
        return compiled[0], {fluents[0]: factor for factor, fluents, _ in compiled[1]}

    def _compile(self, index: int) -> _Filled | None:
        if index not in self._filled:
            self._filled[index] = self._fill_in(self._table.terms[index])
        return self._filled[index]

    def _fill_in(self, terms: tuple[_Term, ...]) -> _Filled | None:
        total: Number = 0
        filled = []
        for term in terms:
            number = self._scaled_value(term) if self.is_stepwise else self._static_value(term)
            if number is None:
                return None
            if not term.changing:
                total = number
            else:
                fluents = tuple(self._index[name] for kind, name in term.changing if kind == FLUENT)
                filled.append((number, fluents, tuple(atom for atom in term.changing if atom[0] != FLUENT)))
        # In a stepwise task a fluent's value carries the unit and so does its coefficient: the constant of a
        # comparison must carry it twice.
        return (total * self._unit if filled else total), tuple(filled)

    def _scaled_value(self, term: _Term) -> int | None:
        total = 0
        scaled = self._scaled
        for coefficient, monomial in term.factors:
            product = coefficient.numerator * (self._unit // (coefficient.denominator * self._grid ** len(monomial)))
            for _, name in monomial:
                if name not in scaled:
                    return None
                product *= scaled[name]
            total += product
        return total

    def _static_value(self, term: _Term) -> Number | None:
        total = Fraction(0)
        for coefficient, monomial in term.factors:
            product = coefficient
            for kind, name in monomial:
                factor = self._values.get(name) if kind == STATIC else self._inverse(name, ())
                if factor is None:
                    return None
                product = product * factor
            total += product
        return _tidy(total)

    def _inverse(self, polynomial: Polynomial, values: Values) -> Fraction | None:
        total = Fraction(0)
        for monomial, coefficient in polynomial.terms:
            product = coefficient
            for kind, name in monomial:
                if kind == FLUENT:
                    value = values[self._index[name]]
                else:
                    value = self._values.get(name) if kind == STATIC else self._inverse(name, values)
                if value is None:
                    return None
                product = product * value
            total += product
        return 1 / total if total else None


def _group(polynomial: Polynomial) -> tuple[_Term, ...]:
    groups: dict[Monomial, list[tuple[Fraction, Monomial]]] = {}
    for monomial, coefficient in polynomial.terms:
        changing = tuple(atom for atom in monomial if not is_static(atom))
        groups.setdefault(changing, []).append((coefficient, tuple(atom for atom in monomial if is_static(atom))))
    return tuple(_Term(changing, tuple(factors)) for changing, factors in groups.items())


def _is_linear(terms: tuple[_Term, ...]) -> bool:
    return all(not term.changing or (len(term.changing) == 1 and term.changing[0][0] == FLUENT) for term in terms)


def _tidy(number: Number) -> Number:
    """Whole fractions as integers, which are much faster."""
    return number.numerator if number.denominator == 1 else number
