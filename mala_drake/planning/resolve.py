"""Resolves `pddl`'s conditions, effects and expressions: declared names, arities and types."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pddl.logic import base, effects, functions, predicates
from pddl.logic.terms import Variable

from mala_drake.planning import syntax
from mala_drake.planning.labels import label_index, label_name, labelled_symbol, type_name
from mala_drake.planning.source import Source

Signatures = Mapping[str, tuple[tuple[str, ...], ...]]
Scope = Mapping[str, tuple[str, ...]]  # The types that each bound variable may have.

_COMPARISONS: dict[type, str] = {
    functions.EqualTo: "=",
    functions.GreaterThan: ">",
    functions.GreaterEqualThan: ">=",
    functions.LesserThan: "<",
    functions.LesserEqualThan: "<=",
}
_ARITHMETIC: dict[type, str] = {functions.Plus: "+", functions.Minus: "-", functions.Times: "*", functions.Divide: "/"}
_ASSIGNMENTS: dict[type, str] = {
    functions.Assign: "assign",
    functions.Increase: "increase",
    functions.Decrease: "decrease",
    functions.ScaleUp: "scale-up",
    functions.ScaleDown: "scale-down",
}


class Resolver:
    """Turns trees of one file into `syntax` trees; every method raises `BadInput` at a name used wrongly."""

    def __init__(
        self,
        source: Source,
        parents: Mapping[str, str],
        objects: Mapping[str, str],
        predicates: Signatures,
        functions: Signatures,
    ) -> None:
        self._source = source
        self._parents = parents
        self._objects = objects
        self._predicates = predicates
        self._functions = functions

    def parameter(self, variable: Variable) -> syntax.Parameter:
        """A declared variable with its types."""
        return syntax.Parameter(label_name(variable.name), _types(variable))

    def condition(self, tree: Any, scope: Scope) -> syntax.Condition:
        """A condition."""
        match tree:
            case base.And() | base.Or():
                parts = tuple(self.condition(part, scope) for part in tree.operands)
                return syntax.And(parts) if isinstance(tree, base.And) else syntax.Or(parts)
            case base.Not():
                return syntax.Not(self.condition(tree.argument, scope))
            case base.Imply():
                premise, conclusion = (self.condition(part, scope) for part in tree.operands)
                return syntax.Or((syntax.Not(premise), conclusion))
            case base.ForallCondition() | base.ExistsCondition():
                variables, inner = self._bind(tree.variables, scope)
                kind = syntax.ForAll if isinstance(tree, base.ForallCondition) else syntax.Exists
                return kind(variables, self.condition(tree.condition, inner))
            case predicates.EqualTo():
                return syntax.Same(self._term(tree.left, scope)[0], self._term(tree.right, scope)[0])
            case predicates.Predicate():
                return self.atom(tree, scope)
        left, right = (self.expression(operand, scope) for operand in tree.operands)
        return syntax.Comparison(_COMPARISONS[type(tree)], left, right)

    def atom(self, tree: Any, scope: Scope, *, wide: bool = True) -> syntax.Atom:
        """An atom of a declared predicate; its variables may be of wider types than the predicate's only if `wide`."""
        return syntax.Atom(*self._application(tree, "predicate", self._predicates, scope, wide=wide))

    def expression(self, tree: Any, scope: Scope) -> syntax.Expression:
        """A numeric expression; its numbers are exact."""
        match tree:
            case functions.NumericFunction():
                symbol = labelled_symbol(self._source, tree.name)
                if symbol.is_number:
                    return symbol.number
                return syntax.Fluent(*self._application(tree, "function", self._functions, scope))
            case functions.UnaryMinus():
                return syntax.Arithmetic("-", (self.expression(tree.operand, scope),))
        operands = tuple(self.expression(operand, scope) for operand in tree.operands)
        return syntax.Arithmetic(_ARITHMETIC[type(tree)], operands)

    def effects(self, tree: Any, scope: Scope) -> tuple[syntax.Effect, ...]:
        """An effect as a flat tuple of simple, conditional and universal ones."""
        match tree:
            case base.And():
                return tuple(effect for part in tree.operands for effect in self.effects(part, scope))
            case effects.When():
                return (syntax.When(self.condition(tree.condition, scope), self.effects(tree.effect, scope)),)
            case effects.Forall():
                variables, inner = self._bind(tree.variables, scope)
                return (syntax.ForEach(variables, self.effects(tree.effect, inner)),)
            case base.Not():
                return (syntax.SetFact(self.atom(tree.argument, scope, wide=False), False),)
            case predicates.Predicate():
                return (syntax.SetFact(self.atom(tree, scope, wide=False), True),)
        head, value = tree.operands
        fluent = syntax.Fluent(*self._application(head, "function", self._functions, scope, wide=False))
        return (syntax.SetFluent(_ASSIGNMENTS[type(tree)], fluent, self.expression(value, scope)),)

    def _application(
        self, tree: Any, kind: str, declared: Signatures, scope: Scope, *, wide: bool = True
    ) -> tuple[str, tuple[str, ...]]:
        name, place = label_name(tree.name), labelled_symbol(self._source, tree.name)
        if name not in declared:
            raise self._source.mistake(place, f"undeclared {kind} '{name}'", f"one declared in :{kind}s")
        signature = declared[name]
        if len(tree.terms) != len(signature):
            raise self._source.mistake(place, f"{kind} '{name}' with {len(tree.terms)} arguments", str(len(signature)))
        terms = []
        for term, allowed in zip(tree.terms, signature, strict=True):
            text, types = self._term(term, scope)
            # What is read may have variables of wider types: for objects that do not fit an atom is false and a fluent
            # undefined, since :init and effects, which must fit, never set them.
            wider = wide and text[0] == "?"
            fits = any if wider else all
            if not fits(self._related(each, allowed, wider=wider) for each in types):
                symbol = labelled_symbol(self._source, term.name)
                raise self._source.mistake(
                    symbol, f"{text} of type {' or '.join(types)} in '{name}'", f"type {' or '.join(allowed)}"
                )
            terms.append(text)
        return name, tuple(terms)

    def _term(self, term: Any, scope: Scope) -> tuple[str, tuple[str, ...]]:
        name = label_name(term.name)
        if name.startswith("?"):
            return name, scope[name]
        if name not in self._objects:
            symbol = labelled_symbol(self._source, term.name)
            raise self._source.mistake(symbol, f"undeclared object '{name}'", "one declared in :objects or :constants")
        return name, (self._objects[name],)

    def _bind(self, variables: Any, scope: Scope) -> tuple[tuple[syntax.Parameter, ...], Scope]:
        parameters = tuple(map(self.parameter, sorted(variables, key=lambda each: label_index(each.name))))
        return parameters, {**scope, **{each.name: each.types for each in parameters}}

    def _related(self, name: str, allowed: tuple[str, ...], *, wider: bool) -> bool:
        return any(self._below(name, each) or (wider and self._below(each, name)) for each in allowed)

    def _below(self, name: str, ancestor: str) -> bool:
        while name and name != ancestor:
            name = self._parents[name]
        return name == ancestor


def _types(variable: Variable) -> tuple[str, ...]:
    return tuple(sorted(type_name(tag) for tag in variable.type_tags))
