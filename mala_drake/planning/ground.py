"""Grounds a task: actions with objects for parameters, conditions without quantifiers, expressions in normal form."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from mala_drake.planning import syntax
from mala_drake.planning.ground_task import (
    TRUE,
    Comparison,
    Condition,
    Effect,
    GroundAction,
    GroundTask,
    Update,
    conjunction,
    disjunction,
    merged,
)
from mala_drake.planning.instantiate import Binding, Rule, instantiate
from mala_drake.planning.polynomial import Polynomial, expand, variable
from mala_drake.planning.syntax import ActionSchema, Description, Fact

_NEGATED = {">": "<=", ">=": "<", "=": "!=", "<": ">=", "<=": ">"}


class Grounder:
    """Grounds a description; what never changes is found once."""

    def __init__(self, description: Description) -> None:
        self._description = description
        changed = list(itertools.chain.from_iterable(_simple_effects(each.effects) for each in description.actions))
        self.changing_predicates = frozenset(
            each.atom.predicate for each in changed if isinstance(each, syntax.SetFact)
        )
        self.changing_functions = frozenset(each.fluent.name for each in changed if isinstance(each, syntax.SetFluent))

    def ground(
        self, facts: Collection[Fact], defined: Iterable[Fact], tick: Callable[[], None] = lambda: None
    ) -> GroundTask:
        """Grounds for all states that `facts` can lead to.

        Args:
            facts: what is true; every state whose facts are all relaxed reachable from these is covered.
            defined: the static fluents that have a value.
            tick: called often; may raise to give up.
        """
        static = frozenset(fact for fact in facts if fact[0] not in self.changing_predicates)
        seed = [*sorted(static), *sorted(("=" + each[0], *each[1:]) for each in defined)]
        seed += sorted(fact for fact in facts if fact[0] in self.changing_predicates)
        binder = _Binder(self._description, tick)
        rules = tuple(self._rule(schema, static, binder) for schema in self._description.actions)
        bindings, reached = instantiate(rules, seed, tick)
        builder = _Builder(binder, self, reached, static)
        actions = []
        for schema, objects in bindings:
            tick()
            action = builder.action(schema, objects)
            if action is not None:
                actions.append(action)
        goal = builder.condition(self._description.goal, {})
        changing = frozenset(fact for fact in reached if fact[0] in self.changing_predicates)
        return GroundTask(tuple(actions), goal, changing)

    def polynomial(self, expression: syntax.Expression, binding: Binding | None = None) -> Polynomial:
        """The normal form of an expression under a binding."""

        def ground_fluent(fluent: syntax.Fluent) -> Polynomial:
            name = (fluent.name, *_bound(fluent.terms, binding or {}))
            return variable(name, static=fluent.name not in self.changing_functions)

        return expand(expression, ground_fluent)

    def _rule(self, schema: ActionSchema, static: frozenset[Fact], binder: _Binder) -> Rule:
        conjuncts = list(_conjuncts(schema.precondition))
        needed = [each.expression for each in schema.effects if isinstance(each, syntax.SetFluent)]
        needed += [
            side for each in conjuncts if isinstance(each, syntax.Comparison) for side in (each.left, each.right)
        ]
        fluents = dict.fromkeys(fluent for expression in needed for fluent in _fluents(expression))
        atoms = [(each.predicate, *each.terms) for each in conjuncts if isinstance(each, syntax.Atom)]
        # An undefined static fluent rules the action out, so that tables of numbers prune bindings as facts do.
        atoms += [("=" + each.name, *each.terms) for each in fluents if each.name not in self.changing_functions]
        tests = [each for each in conjuncts if isinstance(each, syntax.Same | syntax.Not)]

        def check(binding: Binding) -> bool:
            return all(_may_hold(test, binding, static, self.changing_predicates) for test in tests)

        def added(binding: Binding) -> Iterable[Fact]:
            for effect, extended in binder.expand(schema.effects, binding):
                if isinstance(effect, syntax.SetFact) and effect.value:
                    yield (effect.atom.predicate, *_bound(effect.atom.terms, extended))

        domains = {each.name: self._description.objects_of(each.types) for each in schema.parameters}
        return Rule(schema, domains, tuple(dict.fromkeys(atoms)), check, added)


@dataclass(frozen=True, slots=True)
class _Binder:
    """Binds what quantifiers range over; ticks at each binding, for there may be very many."""

    description: Description
    tick: Callable[[], None]

    def bindings(self, variables: tuple[syntax.Parameter, ...], binding: Binding) -> Iterator[Binding]:
        for objects in itertools.product(*(self.description.objects_of(each.types) for each in variables)):
            self.tick()
            yield {**binding, **{each.name: value for each, value in zip(variables, objects, strict=True)}}

    def expand(
        self, effects: Iterable[syntax.Effect], binding: Binding, *, into_conditional: bool = True
    ) -> Iterator[tuple[syntax.Effect, Binding]]:
        for effect in effects:
            if isinstance(effect, syntax.ForEach):
                for extended in self.bindings(effect.variables, binding):
                    yield from self.expand(effect.effects, extended, into_conditional=into_conditional)
            elif isinstance(effect, syntax.When) and into_conditional:
                yield from self.expand(effect.effects, binding)
            else:
                yield effect, binding


class _Builder:
    """Makes ground actions and conditions, leaving out what is settled by what is static or reached."""

    def __init__(self, binder: _Binder, grounder: Grounder, reached: Collection[Fact], static: frozenset[Fact]) -> None:
        self._binder = binder
        self._grounder = grounder
        self._reached = reached
        self._static = static

    def action(self, schema: ActionSchema, objects: tuple[str, ...]) -> GroundAction | None:
        binding = {each.name: value for each, value in zip(schema.parameters, objects, strict=True)}
        precondition = self.condition(schema.precondition, binding)
        if precondition is None:
            return None
        effects = merged(self._effects(schema.effects, binding, TRUE))
        return GroundAction(f"({' '.join((schema.name, *objects))})", precondition, effects)

    def _effects(self, effects: Iterable[syntax.Effect], binding: Binding, guard: Condition) -> Iterator[Effect]:
        added: set[Fact] = set()
        deleted: set[Fact] = set()
        updates: list[Update] = []
        for effect, extended in self._binder.expand(effects, binding, into_conditional=False):
            if isinstance(effect, syntax.SetFact):
                fact = (effect.atom.predicate, *_bound(effect.atom.terms, extended))
                (added if effect.value else deleted).add(fact)
            elif isinstance(effect, syntax.SetFluent):
                updates.append(self._update(effect, extended))
            elif isinstance(effect, syntax.When):
                inner = self.condition(effect.condition, extended)
                if inner is not None:
                    both = conjunction([guard, inner])
                    if both is not None:
                        yield from self._effects(effect.effects, extended, both)
        if added or deleted or updates:
            yield Effect(guard, frozenset(added), frozenset(deleted), tuple(updates))

    def _update(self, effect: syntax.SetFluent, binding: Binding) -> Update:
        value = self._grounder.polynomial(effect.expression, binding)
        fluent = (effect.fluent.name, *_bound(effect.fluent.terms, binding))
        match effect.operator:
            case "increase":
                return Update(fluent, "add", value)
            case "decrease":
                return Update(fluent, "add", value.times(-1))
            case "scale-up":
                return Update(fluent, "scale", value)
            case "scale-down":
                return Update(fluent, "scale", value.inverse())
        return Update(fluent, "set", value)

    def condition(self, tree: syntax.Condition, binding: Binding, *, wanted: bool = True) -> Condition | None:
        """The condition (or its negation) with negations moved inward; None if it can never hold."""
        match tree:
            case syntax.Not():
                return self.condition(tree.part, binding, wanted=not wanted)
            case syntax.Atom():
                return self._literal((tree.predicate, *_bound(tree.terms, binding)), wanted)
            case syntax.Same():
                left, right = _bound((tree.left, tree.right), binding)
                return TRUE if (left == right) == wanted else None
            case syntax.Comparison():
                return self._comparison(tree, binding, wanted)
            case syntax.And() | syntax.Or():
                parts = [self.condition(part, binding, wanted=wanted) for part in tree.parts]
                return conjunction(parts) if isinstance(tree, syntax.And) == wanted else disjunction(parts)
        extended = self._binder.bindings(tree.variables, binding)
        parts = [self.condition(tree.part, each, wanted=wanted) for each in extended]
        return conjunction(parts) if isinstance(tree, syntax.ForAll) == wanted else disjunction(parts)

    def _literal(self, fact: Fact, wanted: bool) -> Condition | None:
        if fact[0] not in self._grounder.changing_predicates:
            return TRUE if (fact in self._static) == wanted else None
        if fact not in self._reached:
            return None if wanted else TRUE
        return Condition(positive=frozenset((fact,))) if wanted else Condition(negative=frozenset((fact,)))

    def _comparison(self, tree: syntax.Comparison, binding: Binding, wanted: bool) -> Condition:
        operator = tree.operator if wanted else _NEGATED[tree.operator]
        difference = self._grounder.polynomial(tree.left, binding) - self._grounder.polynomial(tree.right, binding)
        if operator in ("<", "<="):
            difference, operator = difference.times(-1), {"<": ">", "<=": ">="}[operator]
        return Condition(comparisons=(Comparison(difference, operator),))


def _bound(terms: Iterable[str], binding: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(binding[term] if term[0] == "?" else term for term in terms)


def _simple_effects(effects: Iterable[syntax.Effect]) -> Iterator[syntax.SetFact | syntax.SetFluent]:
    for effect in effects:
        if isinstance(effect, syntax.When | syntax.ForEach):
            yield from _simple_effects(effect.effects)
        else:
            yield effect


def _conjuncts(condition: syntax.Condition) -> Iterator[syntax.Condition]:
    if isinstance(condition, syntax.And):
        for part in condition.parts:
            yield from _conjuncts(part)
    else:
        yield condition


def _fluents(expression: syntax.Expression) -> Iterator[syntax.Fluent]:
    if isinstance(expression, syntax.Fluent):
        yield expression
    elif not isinstance(expression, Fraction):
        for operand in expression.operands:
            yield from _fluents(operand)


def _may_hold(test: syntax.Condition, binding: Binding, static: frozenset[Fact], changing: frozenset[str]) -> bool:
    if isinstance(test, syntax.Same):
        left, right = _bound((test.left, test.right), binding)
        return left == right
    part = test.part if isinstance(test, syntax.Not) else test
    if isinstance(part, syntax.Same):
        return not _may_hold(part, binding, static, changing)
    if isinstance(part, syntax.Atom) and part.predicate not in changing:
        return (part.predicate, *_bound(part.terms, binding)) not in static
    return True
