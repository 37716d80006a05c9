"""Turns a parsed file into text that `pddl` reads: sections in order, names labelled, types explicit.

The result is equivalent PDDL, always with the same requirements: what a file declares under `:requirements` is checked
for spelling, not held against what it uses.
"""

from __future__ import annotations

from collections.abc import Mapping

from mala_drake.planning.formula_text import FormulaText, shown
from mala_drake.planning.labels import OBJECT, make_label, type_label
from mala_drake.planning.source import Group, Node, Source, Symbol

_REQUIREMENTS = "(:requirements :typing :adl :numeric-fluents :fluents :action-costs)"
_KNOWN_REQUIREMENTS = frozenset(
    (
        ":strips",
        ":typing",
        ":equality",
        ":adl",
        ":negative-preconditions",
        ":disjunctive-preconditions",
        ":existential-preconditions",
        ":universal-preconditions",
        ":quantified-preconditions",
        ":conditional-effects",
        ":fluents",
        ":numeric-fluents",
        ":action-costs",
        # For files that declare more than they use; a use is refused where it stands.
        ":derived-predicates",
        ":durative-actions",
        ":duration-inequalities",
        ":timed-initial-literals",
        ":preferences",
        ":constraints",
        ":object-fluents",
        ":continuous-effects",
        ":time",
        ":domain-axioms",
    )
)
_OUTSIDE = {
    ":derived": "derived predicates",
    ":axiom": "derived predicates",
    ":durative-action": "durative actions",
    ":process": "processes",
    ":event": "events",
    ":constraints": "trajectory constraints",
    ":length": "plan length limits",
}
_DOMAIN_SECTIONS = (":requirements", ":types", ":constants", ":predicates", ":functions", ":action")
_PROBLEM_SECTIONS = (":domain", ":requirements", ":objects", ":init", ":goal", ":metric")


def definition_name(source: Source, kind: str) -> Symbol:
    """The name in `(define (kind name) ...)`."""
    header = source.root.items[1] if len(source.root.items) > 1 else source.root
    if not isinstance(header, Group) or header.head != kind or len(header.items) != 2:
        raise source.mistake(header, f"not a {kind} file", f"'(define ({kind} name) ...'")
    name = header.items[1]
    if not isinstance(name, Symbol) or not name.is_name:
        raise source.mistake(name, f"{shown(name)} is not a name")
    return name


def read_sections(source: Source, kind: str) -> dict[str, list[Group]]:
    """The sections of a definition by keyword.

    Raises:
        BadInput: for an unknown, unsupported or repeated section, or an unknown requirement.
    """
    definition_name(source, kind)
    allowed = _DOMAIN_SECTIONS if kind == "domain" else _PROBLEM_SECTIONS
    sections: dict[str, list[Group]] = {keyword: [] for keyword in allowed}
    for node in source.root.items[2:]:
        if not isinstance(node, Group) or not node.head.startswith(":"):
            raise source.mistake(node, f"{shown(node)} where a section should be", f"one of {' '.join(allowed)}")
        if node.head in _OUTSIDE:
            raise source.mistake(node, f"'{node.head}' is outside the supported fragment ({_OUTSIDE[node.head]})")
        if node.head not in sections:
            raise source.mistake(node, f"unknown section '{node.head}'", f"one of {' '.join(allowed)}")
        if sections[node.head] and node.head != ":action":
            raise source.mistake(node, f"a second '{node.head}'", "one")
        sections[node.head].append(node)
    for requirement in _items(sections[":requirements"]):
        if not isinstance(requirement, Symbol) or requirement.text not in _KNOWN_REQUIREMENTS:
            raise source.mistake(requirement, f"unknown requirement {shown(requirement)}", "one of PDDL 3.1")
    return sections


def read_types(source: Source, sections: Mapping[str, list[Group]]) -> dict[str, str]:
    """Every type and its supertype; `object`, the root, has the empty string."""
    items = _items(sections[":types"])
    names = frozenset(each.text for each in items if isinstance(each, Symbol) and each.is_name) | {"object"}
    parents: dict[str, str] = {}
    for symbol, types in FormulaText(source, types=names).typed_list(items, variables=False):
        if len(types) != 1:
            raise source.mistake(symbol, f"type '{symbol.text}' with several supertypes", "one")
        if symbol.text == "object" and types == ("object",):
            continue
        if symbol.text in parents or symbol.text == "object":
            raise source.mistake(symbol, f"type '{symbol.text}' declared twice")
        parents[symbol.text] = types[0]
        if _on_a_cycle(parents, symbol.text):
            raise source.mistake(symbol, f"type '{symbol.text}' is its own supertype")
    for name in sorted(names):
        parents.setdefault(name, "object" if name != "object" else "")
    return parents


def domain_text(source: Source, sections: Mapping[str, list[Group]], parents: Mapping[str, str]) -> str:
    """The domain as text for `pddl`."""
    writer = FormulaText(source, types=frozenset(parents))
    parts = [f"(define (domain {make_label(definition_name(source, 'domain'))})", _REQUIREMENTS, _types_text(parents)]
    parts += _objects_text(source, writer, sections[":constants"], ":constants")
    parts += _signatures_text(source, writer, sections[":predicates"], ":predicates")
    parts += _signatures_text(source, writer, sections[":functions"], ":functions")
    parts += [_action_text(source, writer, action) for action in sections[":action"]]
    return "\n".join([*parts, ")"])


def problem_text(source: Source, sections: Mapping[str, list[Group]], parents: Mapping[str, str]) -> str:
    """The problem as text for `pddl`, without its goal."""
    writer = FormulaText(source, types=frozenset(parents))
    header = sections[":domain"][0] if sections[":domain"] else source.root
    name = header.items[1] if len(header.items) == 2 else header
    if not sections[":domain"] or not isinstance(name, Symbol) or not name.is_name:
        raise source.mistake(header, "the problem does not say which domain it belongs to", "'(:domain name)'")
    parts = [f"(define (problem {make_label(definition_name(source, 'problem'))})", f"(:domain {make_label(name)})"]
    parts += [_REQUIREMENTS, *_objects_text(source, writer, sections[":objects"], ":objects")]
    parts += ["(:init", *(_initial_text(source, writer, node) for node in _items(sections[":init"])), ")"]
    parts.append("(:goal (and))")
    for metric in sections[":metric"]:
        direction = metric.items[1] if len(metric.items) == 3 else metric
        if not isinstance(direction, Symbol) or direction.text not in ("minimize", "maximize"):
            raise source.mistake(direction, "not a metric", "'(:metric minimize|maximize expression)'")
        parts.append(f"(:metric {direction.text} {writer.expression(metric.items[2], {}, ground=True)})")
    return "\n".join([*parts, ")"])


def goal_text(source: Source, sections: Mapping[str, list[Group]], parents: Mapping[str, str]) -> str:
    """The goal as the precondition of an action, in a domain of its own.

    `pddl` refuses or, imply, forall, exists and = in the goal of a problem, but reads them there.
    """
    if not sections[":goal"] or len(sections[":goal"][0].items) != 2:
        node = sections[":goal"][0] if sections[":goal"] else source.root
        raise source.mistake(
            node, "the problem has no goal" if node is source.root else "not a goal", "'(:goal condition)'"
        )
    condition = FormulaText(source, types=frozenset(parents)).condition(sections[":goal"][0].items[1], {})
    action = f"(:action goal--0 :parameters () :precondition {condition} :effect (and))"
    return f"(define (domain goal--0) {_REQUIREMENTS} {_types_text(parents)} {action})"


def _items(groups: list[Group]) -> tuple[Node, ...]:
    return tuple(item for group in groups for item in group.items[1:])


def _on_a_cycle(parents: Mapping[str, str], name: str) -> bool:
    above = parents[name]
    while above in parents and above != name:
        above = parents[above]
    return above == name


def _types_text(parents: Mapping[str, str]) -> str:
    entries = [f"{type_label(name)} - {type_label(parent)}" for name, parent in parents.items() if parent]
    return f"(:types {' '.join([*entries, type_label('object')])})"


def _objects_text(source: Source, writer: FormulaText, groups: list[Group], keyword: str) -> list[str]:
    entries = []
    for symbol, types in writer.typed_list(_items(groups), variables=False):
        if len(types) != 1:
            raise source.mistake(symbol, f"object '{symbol.text}' of several types", "one")
        entries.append(f"{make_label(symbol, kind=OBJECT)} - {type_label(types[0])}")
    return [f"({keyword} {' '.join(entries)})"] if entries else []


def _signatures_text(source: Source, writer: FormulaText, groups: list[Group], keyword: str) -> list[str]:
    entries: list[str] = []
    items = list(_items(groups))
    while items:
        node = items.pop(0)
        if keyword == ":functions" and isinstance(node, Symbol) and node.text == "-" and entries and items:
            kind = items.pop(0)
            if not isinstance(kind, Symbol) or kind.text != "number":
                raise source.mistake(kind, f"function type {shown(kind)} is outside the supported fragment", "'number'")
            continue
        head = node.items[0] if isinstance(node, Group) and node.items else node
        if not isinstance(node, Group) or not isinstance(head, Symbol) or not head.is_name:
            raise source.mistake(head, f"{shown(head)} in {keyword}", "'(name ?variable - type ...)'")
        variables, _ = writer.bind(node.items[1:], {})
        entries.append(f"({make_label(head)} {variables[1:-1]})")
    return [f"({keyword} {' '.join(entries)})"] if entries else []


def _action_text(source: Source, writer: FormulaText, action: Group) -> str:
    name = action.items[1] if len(action.items) > 1 else action
    if not isinstance(name, Symbol) or not name.is_name:
        raise source.mistake(name, "an action without a name", "'(:action name ...'")
    fields = _action_fields(source, action)
    parameters = fields.get(":parameters", Group((), action.line, action.column))
    if not isinstance(parameters, Group):
        raise source.mistake(parameters, f"{shown(parameters)} after :parameters", "'(?variable - type ...)'")
    variables, scope = writer.bind(parameters.items, {})
    precondition = writer.condition(fields[":precondition"], scope) if ":precondition" in fields else "(and)"
    effects = writer.effects(fields[":effect"], scope) if ":effect" in fields else []
    return (
        f"(:action {make_label(name)} :parameters {variables}\n"
        f"  :precondition {precondition}\n  :effect (and {' '.join(effects)}))"
    )


def _action_fields(source: Source, action: Group) -> dict[str, Node]:
    fields: dict[str, Node] = {}
    body = action.items[2:]
    for keyword, value in zip(body[::2], (*body[1::2], None), strict=False):
        if not isinstance(keyword, Symbol) or keyword.text not in (":parameters", ":precondition", ":effect"):
            raise source.mistake(
                keyword, f"{shown(keyword)} in an action", "':parameters', ':precondition' or ':effect'"
            )
        if value is None:
            raise source.mistake(keyword, f"nothing after '{keyword.text}'")
        if keyword.text in fields:
            raise source.mistake(keyword, f"a second '{keyword.text}'", "one")
        fields[keyword.text] = value
    return fields


def _initial_text(source: Source, writer: FormulaText, node: Node) -> str:
    if isinstance(node, Group) and node.head == "=":
        value = node.items[2] if len(node.items) == 3 else node
        target = node.items[1] if len(node.items) == 3 else node
        is_fluent = target.is_name if isinstance(target, Symbol) else target.head not in ("+", "-", "*", "/", "=", "")
        if not isinstance(value, Symbol) or not value.is_number or not is_fluent:
            raise source.mistake(value, "not an initial value", "'(= (fluent object ...) number)'")
        # The number itself may be negative, or too long for a float: its index leads to the exact word.
        return f"(= {writer.expression(target, {}, ground=True)} {value.index})"
    if isinstance(node, Group) and node.head == "not" and len(node.items) == 2:
        return f"(not {writer.atom(node.items[1], {}).replace('?', '')})"
    if isinstance(node, Group) and node.head == "at" and len(node.items) == 3 and isinstance(node.items[2], Group):
        raise source.mistake(node, "timed initial literals are outside the supported fragment")
    return writer.atom(node, {}).replace("?", "")
