"""Executes actions on the lifted task itself, one object binding at a time.

Deliberately naive and independent of grounding and search, which are checked against it: conditions and effects are
walked as they stand in the file, on states by name. Conditions are three-valued, because a comparison of an undefined
fluent is neither true nor false; an action is applicable only if its precondition is true.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Iterator, Mapping
from fractions import Fraction

from mala_drake.errors import BadInput
from mala_drake.planning import syntax
from mala_drake.planning.state import SymbolicState, as_fact
from mala_drake.planning.syntax import Description, Fact

_COMPARE = {">": operator.gt, ">=": operator.ge, "=": operator.eq, "<=": operator.le, "<": operator.lt}

Binding = Mapping[str, str]


class UndefinedError(Exception):
    """An expression reads a fluent without a value, or divides by zero."""


class Interpreter:
    """Evaluates conditions and applies actions of one task."""

    def __init__(self, description: Description) -> None:
        self._description = description
        self._schemas = {schema.name: schema for schema in description.actions}

    def is_goal(self, state: SymbolicState) -> bool:
        """Whether the goal is true."""
        return self.truth(self._description.goal, state, {}) is True

    def metric_value(self, state: SymbolicState) -> Fraction | None:
        """The metric, None if there is none or it is undefined."""
        metric = self._description.metric
        try:
            return None if metric is None else self.number(metric.expression, state, {})
        except UndefinedError:
            return None

    def is_applicable(self, state: SymbolicState, action: str) -> bool:
        """Whether `apply` would succeed."""
        try:
            self.apply(state, action)
        except ValueError:
            return False
        return True

    def apply(self, state: SymbolicState, action: str) -> SymbolicState:
        """The state after an action.

        Raises:
            BadInput: if there is no such action.
            ValueError: if it is not applicable.
        """
        schema, binding = self._lookup(action)
        if self.truth(schema.precondition, state, binding) is not True:
            raise ValueError(f"{action}: the precondition does not hold")
        fired = list(self._fired(schema.effects, state, binding))
        deleted = {_ground(e.atom, b) for e, b in fired if isinstance(e, syntax.SetFact) and not e.value}
        added = {_ground(e.atom, b) for e, b in fired if isinstance(e, syntax.SetFact) and e.value}
        try:
            values = self._assigned([(e, b) for e, b in fired if isinstance(e, syntax.SetFluent)], state)
        except UndefinedError:
            raise ValueError(f"{action}: an effect is undefined") from None
        return SymbolicState((state.facts - deleted) | added, {**state.values, **values})

    def truth(self, condition: syntax.Condition, state: SymbolicState, binding: Binding) -> bool | None:
        """Whether a condition is true; None if that hangs on something undefined."""
        match condition:
            case syntax.Atom():
                return _ground(condition, binding) in state.facts
            case syntax.Same():
                return binding.get(condition.left, condition.left) == binding.get(condition.right, condition.right)
            case syntax.Not():
                inner = self.truth(condition.part, state, binding)
                return None if inner is None else not inner
            case syntax.And() | syntax.Or():
                parts = (self.truth(part, state, binding) for part in condition.parts)
                return _all(parts) if isinstance(condition, syntax.And) else _any(parts)
            case syntax.ForAll() | syntax.Exists():
                bindings = self._bindings(condition.variables, binding)
                parts = (self.truth(condition.part, state, each) for each in bindings)
                return _all(parts) if isinstance(condition, syntax.ForAll) else _any(parts)
        try:
            left = self.number(condition.left, state, binding)
            return _COMPARE[condition.operator](left, self.number(condition.right, state, binding))
        except UndefinedError:
            return None

    def number(self, expression: syntax.Expression, state: SymbolicState, binding: Binding) -> Fraction:
        """The value of an expression.

        Raises:
            UndefinedError: if it has none.
        """
        if isinstance(expression, Fraction):
            return expression
        if isinstance(expression, syntax.Fluent):
            value = state.values.get((expression.name, *(binding.get(term, term) for term in expression.terms)))
            if value is None:
                raise UndefinedError
            return value
        first, *rest = [self.number(operand, state, binding) for operand in expression.operands]
        if expression.operator == "-" and not rest:
            return -first
        for operand in rest:
            match expression.operator:
                case "+":
                    first += operand
                case "-":
                    first -= operand
                case "*":
                    first *= operand
                case _:
                    if operand == 0:
                        raise UndefinedError
                    first /= operand
        return first

    def _lookup(self, action: str) -> tuple[syntax.ActionSchema, Binding]:
        name, *objects = as_fact(action) or ("",)
        schema = self._schemas.get(name)
        if schema is None or len(objects) != len(schema.parameters):
            raise BadInput(action, "no such action", f"one of {' '.join(sorted(self._schemas))} with its objects")
        for each, parameter in zip(objects, schema.parameters, strict=True):
            if each not in self._description.objects_of(parameter.types):
                raise BadInput(action, f"'{each}' cannot be {parameter.name}", f"a {' or '.join(parameter.types)}")
        return schema, {each.name: value for each, value in zip(schema.parameters, objects, strict=True)}

    def _fired(
        self, effects: tuple[syntax.Effect, ...], state: SymbolicState, binding: Binding
    ) -> Iterator[tuple[syntax.SetFact | syntax.SetFluent, Binding]]:
        for effect in effects:
            if isinstance(effect, syntax.When):
                if self.truth(effect.condition, state, binding) is True:
                    yield from self._fired(effect.effects, state, binding)
            elif isinstance(effect, syntax.ForEach):
                for extended in self._bindings(effect.variables, binding):
                    yield from self._fired(effect.effects, state, extended)
            else:
                yield effect, binding

    def _assigned(self, effects: list[tuple[syntax.SetFluent, Binding]], state: SymbolicState) -> dict[Fact, Fraction]:
        by_fluent: dict[Fact, list[tuple[str, Fraction]]] = {}
        for effect, binding in effects:
            fluent = (effect.fluent.name, *(binding.get(term, term) for term in effect.fluent.terms))
            amount = self.number(effect.expression, state, binding)
            by_fluent.setdefault(fluent, []).append((effect.operator, amount))
        return {fluent: _changed(state.values.get(fluent), changes) for fluent, changes in by_fluent.items()}

    def _bindings(self, variables: tuple[syntax.Parameter, ...], binding: Binding) -> Iterator[Binding]:
        for objects in itertools.product(*(self._description.objects_of(each.types) for each in variables)):
            yield {**binding, **{each.name: value for each, value in zip(variables, objects, strict=True)}}


def _changed(before: Fraction | None, changes: list[tuple[str, Fraction]]) -> Fraction:
    operators = {name for name, _ in changes}
    amounts = [amount for _, amount in changes]
    if operators == {"assign"}:
        if len(set(amounts)) > 1:
            raise UndefinedError
        return amounts[0]
    if before is None:
        raise UndefinedError
    if operators <= {"increase", "decrease"}:
        return before + sum(amount if name == "increase" else -amount for name, amount in changes)
    if not operators <= {"scale-up", "scale-down"}:
        raise UndefinedError
    for name, amount in changes:
        if name == "scale-down" and amount == 0:
            raise UndefinedError
        before = before * amount if name == "scale-up" else before / amount
    return before


def _ground(atom: syntax.Atom, binding: Binding) -> Fact:
    return (atom.predicate, *(binding.get(term, term) for term in atom.terms))


def _all(parts: Iterator[bool | None]) -> bool | None:
    found = list(parts)
    return False if False in found else None if None in found else True


def _any(parts: Iterator[bool | None]) -> bool | None:
    found = list(parts)
    return True if True in found else None if None in found else False
