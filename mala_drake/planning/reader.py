"""Reads a domain and a problem with `pddl` and resolves every name in them.

The one module that knows `pddl`: its trees come in, `syntax` trees go out.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from functools import cache
from typing import Any

from lark.exceptions import LarkError
from pddl.core import Domain, Problem
from pddl.exceptions import PDDLParsingError, PDDLValidationError
from pddl.logic.base import Not
from pddl.logic.functions import EqualTo as NumbersEqual
from pddl.parser.domain import DomainParser
from pddl.parser.problem import ProblemParser

from mala_drake.errors import BadInput
from mala_drake.planning import syntax
from mala_drake.planning.labels import label_index, label_name, labelled_symbol, type_name
from mala_drake.planning.normalise import (
    definition_name,
    domain_text,
    goal_text,
    problem_text,
    read_sections,
    read_types,
)
from mala_drake.planning.resolve import Resolver, Signatures
from mala_drake.planning.source import Source, parse_source

_TOTAL_TIME = "total-time"
_TOTAL_COST = "total-cost"


@cache
def _parser(kind: str) -> Any:
    # Building one takes 150 ms, so they are kept.
    return DomainParser() if kind == "domain" else ProblemParser()


def _parse(kind: str, text: str, source: Source) -> Any:
    limit = getattr(sys, "tracebacklimit", None)
    try:
        return _parser(kind)(text)
    except (LarkError, PDDLParsingError, PDDLValidationError, ValueError, AssertionError) as error:
        _parser.cache_clear()  # A parser that failed once keeps half a tree and never works again.
        raise BadInput(source.name, f"pddl cannot read it ({str(error).splitlines()[0]})") from None
    finally:
        # The parser leaves this changed, which would cost the whole program its tracebacks.
        if limit is not None:
            sys.tracebacklimit = limit
        elif hasattr(sys, "tracebacklimit"):
            del sys.tracebacklimit


def read_description(
    domain: str, problem: str, *, domain_name: str = "domain", problem_name: str = "problem"
) -> syntax.Description:
    """The planning task that two PDDL texts describe.

    Args:
        domain: text of the domain file.
        problem: text of the problem file.
        domain_name: what messages call the domain file.
        problem_name: what messages call the problem file.

    Raises:
        BadInput: for anything that is not PDDL, not consistent, or outside the supported fragment, with
            `file:line:column`.
    """
    domain_source = parse_source(domain, name=domain_name)
    problem_source = parse_source(problem, name=problem_name)
    domain_sections = read_sections(domain_source, "domain")
    problem_sections = read_sections(problem_source, "problem")
    parents = read_types(domain_source, domain_sections)
    domain_tree = _parse("domain", domain_text(domain_source, domain_sections, parents), domain_source)
    problem_tree = _parse("problem", problem_text(problem_source, problem_sections, parents), problem_source)
    goal_tree = _parse("domain", goal_text(problem_source, problem_sections, parents), problem_source)
    _check_names_agree(domain_source, problem_source, problem_tree)
    return _Description(domain_source, problem_source, domain_tree, problem_tree, goal_tree).build()


def _check_names_agree(domain_source: Source, problem_source: Source, problem: Problem) -> None:
    declared = definition_name(domain_source, "domain").text
    if label_name(problem.domain_name) != declared:
        place = labelled_symbol(problem_source, problem.domain_name)
        raise problem_source.mistake(place, f"the problem is for domain '{place.text}'", f"'{declared}'")


class _Description:
    """Collects declarations first, then resolves what uses them."""

    def __init__(
        self, domain_source: Source, problem_source: Source, domain: Domain, problem: Problem, goal: Domain
    ) -> None:
        self._domain_source, self._problem_source = domain_source, problem_source
        self._domain, self._problem, self._goal = domain, problem, goal
        self._parents = {type_name(name): type_name(above or "") for name, above in domain.types.items()}
        self._objects = dict[str, str]()
        self._declare_objects(domain_source, domain.constants)
        constants = dict(self._objects)
        self._declare_objects(problem_source, problem.objects)
        self._predicates = _signatures(domain_source, domain.predicates)
        self._functions = _signatures(domain_source, domain.functions)
        # A metric may read `total-time` without a declaration: it is the number of steps.
        metric_functions: Signatures = {_TOTAL_TIME: (), **self._functions}
        self._in_domain = Resolver(domain_source, self._parents, constants, self._predicates, self._functions)
        self._in_problem = Resolver(problem_source, self._parents, self._objects, self._predicates, self._functions)
        self._in_metric = Resolver(problem_source, self._parents, self._objects, self._predicates, metric_functions)

    def build(self) -> syntax.Description:
        """The finished task."""
        facts, values = self._initial_state()
        actions = [self._action(tree) for tree in sorted(self._domain.actions, key=lambda each: label_index(each.name))]
        goal_action = next(iter(self._goal.actions))
        functions = dict(self._functions)
        metric = self._metric()
        if metric is not None and _TOTAL_TIME not in functions and _reads(metric.expression, _TOTAL_TIME):
            functions[_TOTAL_TIME] = ()
            values[_TOTAL_TIME,] = Fraction(0)
            step = syntax.SetFluent("increase", syntax.Fluent(_TOTAL_TIME, ()), Fraction(1))
            actions = [_with_effect(action, step) for action in actions]
        if functions.get(_TOTAL_COST) == ():
            values.setdefault((_TOTAL_COST,), Fraction(0))
        return syntax.Description(
            domain_name=label_name(self._domain.name),
            problem_name=label_name(self._problem.name),
            parents=self._parents,
            objects=self._objects,
            predicates=self._predicates,
            functions=functions,
            actions=tuple(sorted(actions, key=lambda action: action.name)),
            facts=facts,
            values=values,
            goal=self._in_problem.condition(goal_action.precondition, {}),
            metric=metric,
        )

    def _declare_objects(self, source: Source, terms: Any) -> None:
        for term in sorted(terms, key=lambda each: label_index(each.name)):
            name = label_name(term.name)
            if name in self._objects:
                raise source.mistake(labelled_symbol(source, term.name), f"object '{name}' declared twice")
            self._objects[name] = type_name(term.type_tag)

    def _action(self, tree: Any) -> syntax.ActionSchema:
        name = label_name(tree.name)
        same = [each for each in self._domain.actions if label_name(each.name) == name]
        if len(same) > 1:
            last = max((each.name for each in same), key=label_index)
            raise self._domain_source.mistake(
                labelled_symbol(self._domain_source, last), f"action '{name}' defined twice"
            )
        parameters = tuple(self._in_domain.parameter(variable) for variable in tree.parameters)
        scope = {parameter.name: parameter.types for parameter in parameters}
        return syntax.ActionSchema(
            name=name,
            parameters=parameters,
            precondition=self._in_domain.condition(tree.precondition, scope),
            effects=self._in_domain.effects(tree.effect, scope),
        )

    def _initial_state(self) -> tuple[frozenset[syntax.Fact], dict[syntax.Fact, Fraction]]:
        resolver, source = self._in_problem, self._problem_source
        facts: dict[syntax.Fact, bool] = {}
        values: dict[syntax.Fact, Fraction] = {}
        for tree in sorted(self._problem.init, key=_first_index):
            if isinstance(tree, NumbersEqual):
                head, number = tree.operands
                fluent = resolver.expression(head, {})
                assert isinstance(fluent, syntax.Fluent)
                key = (fluent.name, *fluent.terms)
                value = source.symbols[int(number.value)].number
                if values.setdefault(key, value) != value:
                    raise source.mistake(
                        labelled_symbol(source, head.name), f"two values for ({' '.join(key)})", "one initial value"
                    )
                continue
            atom_tree, truth = (tree.argument, False) if isinstance(tree, Not) else (tree, True)
            atom = resolver.atom(atom_tree, {})
            key = (atom.predicate, *atom.terms)
            if facts.setdefault(key, truth) != truth:
                raise source.mistake(
                    labelled_symbol(source, atom_tree.name), f"({' '.join(key)}) is both true and false in :init"
                )
        return frozenset(fact for fact, truth in facts.items() if truth), values

    def _metric(self) -> syntax.Metric | None:
        tree = self._problem.metric
        if tree is None:
            return None
        return syntax.Metric(tree.optimization == "minimize", self._in_metric.expression(tree.expression, {}))


def _with_effect(action: syntax.ActionSchema, effect: syntax.Effect) -> syntax.ActionSchema:
    return syntax.ActionSchema(action.name, action.parameters, action.precondition, (*action.effects, effect))


def _reads(expression: syntax.Expression, name: str) -> bool:
    if isinstance(expression, syntax.Fluent):
        return expression.name == name
    return isinstance(expression, syntax.Arithmetic) and any(_reads(each, name) for each in expression.operands)


def _first_index(tree: Any) -> int:
    if isinstance(tree, NumbersEqual):
        return label_index(tree.operands[0].name)
    return label_index((tree.argument if isinstance(tree, Not) else tree).name)


def _signatures(source: Source, trees: Any) -> dict[str, tuple[tuple[str, ...], ...]]:
    result: dict[str, tuple[tuple[str, ...], ...]] = {}
    for tree in sorted(trees, key=lambda each: label_index(each.name)):
        name = label_name(tree.name)
        if name in result:
            raise source.mistake(labelled_symbol(source, tree.name), f"'{name}' declared twice")
        result[name] = tuple(tuple(sorted(type_name(tag) for tag in term.type_tags)) for term in tree.terms)
    return result
