"""Which bindings of an action's parameters can ever be applicable: a join over its positive preconditions.

Facts are taken from a queue, static ones first. Each is matched with every positive precondition atom of its
predicate, and the other atoms are joined over the facts taken before, the most constrained first; the atoms that the
binding adds join the queue. What comes out is exactly the relaxed reachable set, where nothing is ever deleted, and no
binding outside it is ever enumerated.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from mala_drake.planning.syntax import ActionSchema, Fact, Parameter

Binding = dict[str, str]


@dataclass(frozen=True, slots=True)
class Rule:
    """An action as the join sees it.

    `atoms` are patterns that must match a fact (their terms may be variables), `check` refuses full bindings for other
    reasons, `added` lists the facts that a binding makes true.
    """

    schema: ActionSchema
    domains: dict[str, tuple[str, ...]]
    atoms: tuple[Fact, ...]
    check: Callable[[Binding], bool]
    added: Callable[[Binding], Iterable[Fact]]


@dataclass(slots=True)
class Reached:
    """Facts seen so far, indexed by predicate and by each argument."""

    facts: set[Fact] = field(default_factory=set)
    _by_predicate: dict[str, list[Fact]] = field(default_factory=dict)
    _by_argument: dict[tuple[str, int, str], list[Fact]] = field(default_factory=dict)

    def take(self, fact: Fact) -> None:
        """Adds a fact to the index."""
        self._by_predicate.setdefault(fact[0], []).append(fact)
        for position, argument in enumerate(fact[1:], start=1):
            self._by_argument.setdefault((fact[0], position, argument), []).append(fact)

    def candidates(self, pattern: Fact, binding: Binding) -> list[Fact]:
        """The facts that may match a pattern: the shortest list that its bound arguments give."""
        best = self._by_predicate.get(pattern[0], [])
        for position, term in enumerate(pattern[1:], start=1):
            value = binding.get(term, None if term[0] == "?" else term)
            if value is not None:
                found = self._by_argument.get((pattern[0], position, value), [])
                best = found if len(found) < len(best) else best
        return best


def instantiate(
    rules: tuple[Rule, ...], facts: Iterable[Fact], tick: Callable[[], None]
) -> tuple[list[tuple[ActionSchema, tuple[str, ...]]], set[Fact]]:
    """The relaxed reachable bindings, sorted by action and objects, and the relaxed reachable facts.

    Args:
        rules: one an action.
        facts: what is true at the start; static facts first make the joins short.
        tick: called often; may raise to give up.
    """
    reached = Reached()
    queue = deque(facts)
    reached.facts.update(queue)
    found: dict[tuple[int, tuple[str, ...]], None] = {}
    users: dict[str, list[tuple[int, int]]] = {}
    for number, rule in enumerate(rules):
        for position, atom in enumerate(rule.atoms):
            users.setdefault(atom[0], []).append((number, position))

    def accept(number: int, binding: Binding) -> None:
        rule = rules[number]
        key = (number, tuple(binding[parameter.name] for parameter in rule.schema.parameters))
        tick()
        if key in found or not rule.check(binding):
            return
        found[key] = None
        for fact in rule.added(binding):
            if fact not in reached.facts:
                reached.facts.add(fact)
                queue.append(fact)

    for number, rule in enumerate(rules):
        if not rule.atoms:
            for binding in _complete(rule, {}):
                accept(number, binding)
    while queue:
        fact = queue.popleft()
        tick()
        reached.take(fact)
        for number, position in users.get(fact[0], ()):
            rule = rules[number]
            start = _match(rule, rule.atoms[position], fact, {})
            if start is not None:
                rest = rule.atoms[:position] + rule.atoms[position + 1 :]
                for binding in _join(rule, rest, start, reached, tick):
                    accept(number, binding)
    ordered = sorted(found, key=lambda key: (rules[key[0]].schema.name, key[1]))
    return [(rules[number].schema, objects) for number, objects in ordered], reached.facts


def _join(
    rule: Rule, atoms: tuple[Fact, ...], binding: Binding, reached: Reached, tick: Callable[[], None]
) -> Iterator[Binding]:
    tick()
    if not atoms:
        yield from _complete(rule, binding)
        return
    choices = [reached.candidates(atom, binding) for atom in atoms]
    best = min(range(len(atoms)), key=lambda index: len(choices[index]))
    rest = atoms[:best] + atoms[best + 1 :]
    for fact in tuple(choices[best]):
        extended = _match(rule, atoms[best], fact, binding)
        if extended is not None:
            yield from _join(rule, rest, extended, reached, tick)


def _match(rule: Rule, pattern: Fact, fact: Fact, binding: Binding) -> Binding | None:
    if len(pattern) != len(fact):
        return None
    extended = dict(binding)
    for term, value in zip(pattern[1:], fact[1:], strict=True):
        if term[0] != "?":
            if term != value:
                return None
        elif extended.setdefault(term, value) != value or value not in rule.domains[term]:
            return None
    return extended


def _complete(rule: Rule, binding: Binding) -> Iterator[Binding]:
    free: list[Parameter] = [each for each in rule.schema.parameters if each.name not in binding]
    if not free:
        yield binding
        return
    for value in rule.domains[free[0].name]:
        yield from _complete(rule, {**binding, free[0].name: value})
