"""Rewrites conditions, effects and expressions into the form that `pddl` accepts, with labelled names.

Legal or common PDDL that `pddl` 0.5.1 refuses comes out in a form it reads: `()`, nested `and` in effects, `when`
around `when`, `forall` or `and`, unary `+` and `*`, bare fluents without arguments. What is outside the supported
fragment is refused here, where the place in the file is known.
"""

from __future__ import annotations

from collections.abc import Mapping

from mala_drake.planning.labels import OBJECT, VARIABLE, make_label, type_label
from mala_drake.planning.source import Group, Node, Source, Symbol

COMPARISONS = (">", ">=", "=", "<=", "<")
ASSIGNMENTS = ("assign", "increase", "decrease", "scale-up", "scale-down")
_LOGIC = ("and", "or", "not", "imply", "forall", "exists", "when")
_OUTSIDE = {
    "preference": "preferences",
    "always": "trajectory constraints",
    "sometime": "trajectory constraints",
    "within": "trajectory constraints",
    "at-most-once": "trajectory constraints",
    "sometime-after": "trajectory constraints",
    "sometime-before": "trajectory constraints",
    "always-within": "trajectory constraints",
    "hold-during": "trajectory constraints",
    "hold-after": "trajectory constraints",
    "oneof": "non-deterministic effects",
    "probabilistic": "probabilistic effects",
}

Scope = Mapping[str, str]  # Variables that may be used, and the name each goes by in the text for `pddl`.


class FormulaText:
    """Writes parts of one source as text for `pddl`; every method raises `BadInput` at what it cannot accept."""

    def __init__(self, source: Source, *, types: frozenset[str]) -> None:
        self._source = source
        self._types = types

    def typed_list(self, items: tuple[Node, ...], *, variables: bool) -> list[tuple[Symbol, tuple[str, ...]]]:
        """The entries of `a b - type c - (either t u)`, each with the types it may have."""
        result: list[tuple[Symbol, tuple[str, ...]]] = []
        untyped: list[Symbol] = []
        position = 0
        while position < len(items):
            item = items[position]
            if isinstance(item, Symbol) and item.text == "-":
                if not untyped or position + 1 == len(items):
                    raise self._source.mistake(item, "'-' out of place", "'name ... - type'")
                types = self._type(items[position + 1])
                result += [(symbol, types) for symbol in untyped]
                untyped = []
                position += 2
                continue
            if not isinstance(item, Symbol) or not (item.is_variable if variables else item.is_name):
                raise self._source.mistake(
                    item, f"{shown(item)} in a typed list", "?variable" if variables else "a name"
                )
            untyped.append(item)
            position += 1
        return result + [(symbol, ("object",)) for symbol in untyped]

    def _type(self, node: Node) -> tuple[str, ...]:
        choices = node.items[1:] if isinstance(node, Group) and node.head == "either" else (node,)
        if not choices:
            raise self._source.mistake(node, "(either) without types", "at least one type")
        for choice in choices:
            if not isinstance(choice, Symbol) or choice.text not in self._types:
                raise self._source.mistake(choice, f"unknown type {shown(choice)}", "a type declared in :types")
        return tuple(choice.text for choice in choices if isinstance(choice, Symbol))

    def bind(self, items: tuple[Node, ...], scope: Scope) -> tuple[str, dict[str, str]]:
        """A list of variables as text, and the scope inside it; a name already in use gets a new one."""
        inner = dict(scope)
        declared: set[str] = set()
        entries = []
        for symbol, types in self.typed_list(items, variables=True):
            if symbol.text in declared:
                raise self._source.mistake(symbol, f"variable {symbol.text} declared twice")
            declared.add(symbol.text)
            inner[symbol.text] = symbol.text if symbol.text not in scope else f"{symbol.text}--{symbol.index}"
            label = make_label(symbol, kind=VARIABLE, name=inner[symbol.text])
            entries.append(f"?{label} - (either {' '.join(type_label(each) for each in types)})")
        return f"({' '.join(entries)})", inner

    def condition(self, node: Node, scope: Scope) -> str:
        """A condition as text."""
        if isinstance(node, Symbol):
            raise self._source.mistake(node, f"{shown(node)} is not a condition", "one in parentheses")
        if not node.items:
            return "(and)"
        head, arguments = node.head, node.items[1:]
        if head in ("and", "or"):
            return f"({' '.join([head, *(self.condition(part, scope) for part in arguments)])})"
        if head in ("not", "imply"):
            self._expect(node, 1 if head == "not" else 2)
            return f"({head} {' '.join(self.condition(part, scope) for part in arguments)})"
        if head in ("forall", "exists"):
            variables, inner = self._quantified(node, scope)
            return f"({head} {variables} {self.condition(arguments[1], inner)})"
        if head in COMPARISONS:
            self._expect(node, 2)
            return self._comparison(node, scope)
        return self.atom(node, scope)

    def _comparison(self, node: Group, scope: Scope) -> str:
        left, right = node.items[1:]
        if node.head == "=" and all(isinstance(side, Symbol) and not side.is_number for side in (left, right)):
            return f"(= {self._term(left, scope)} {self._term(right, scope)})"
        return f"({node.head} {self.expression(left, scope)} {self.expression(right, scope)})"

    def atom(self, node: Node, scope: Scope) -> str:
        """`(predicate term ...)` as text."""
        head = node.items[0] if isinstance(node, Group) and node.items else node
        if not isinstance(node, Group) or not isinstance(head, Symbol) or not head.is_name:
            raise self._source.mistake(head, f"{shown(head)} where an atom should be", "'(predicate term ...)'")
        if head.text in _OUTSIDE:
            raise self._source.mistake(node, f"'{head.text}' is outside the supported fragment ({_OUTSIDE[head.text]})")
        if head.text in ("at", "over") and len(node.items) == 3 and isinstance(node.items[2], Group):
            raise self._source.mistake(node, "timed conditions and effects are outside the supported fragment")
        if head.text in (*_LOGIC, *ASSIGNMENTS):
            raise self._source.mistake(node, f"'{head.text}' out of place", "an atom")
        return f"({' '.join([make_label(head), *(self._term(term, scope) for term in node.items[1:])])})"

    def _term(self, node: Node, scope: Scope) -> str:
        if not isinstance(node, Symbol) or not (node.is_variable or node.is_name):
            raise self._source.mistake(node, f"{shown(node)} is not a term", "an object or a ?variable")
        if not node.is_variable:
            # pddl stops without a place at an object it does not know; as a variable it goes through, and
            # the reader, which can name the place, resolves it.
            return "?" + make_label(node, kind=OBJECT)
        if node.text not in scope:
            raise self._source.mistake(node, f"undeclared variable {node.text}", "a parameter or a quantified variable")
        return "?" + make_label(node, kind=VARIABLE, name=scope[node.text])

    def expression(self, node: Node, scope: Scope, *, ground: bool = False) -> str:
        """A numeric expression as text; a ground one (in `:metric`) has objects where others have terms."""
        if isinstance(node, Symbol):
            if not node.is_number and not node.is_name:
                raise self._source.mistake(node, f"{shown(node)} is not a number", "a number or a fluent")
            return f"({make_label(node)})"
        head, operands = node.head, node.items[1:]
        if head in ("+", "*", "-", "/"):
            most = {"-": 2, "/": 2}.get(head)
            if not operands or (most and len(operands) > most) or (head == "/" and len(operands) == 1):
                raise self._source.mistake(node, f"'{head}' with {len(operands)} operands")
            parts = [self.expression(operand, scope, ground=ground) for operand in operands]
            return parts[0] if len(parts) == 1 and head != "-" else f"({head} {' '.join(parts)})"
        if head.startswith("is-violated"):
            raise self._source.mistake(node, "'is-violated' is outside the supported fragment (preferences)")
        if not node.items or not isinstance(node.items[0], Symbol) or not node.items[0].is_name:
            raise self._source.mistake(
                node, f"{shown(node)} is not a numeric expression", "a number, fluent or + - * /"
            )
        terms = [self._term(term, scope) for term in operands]
        return f"({' '.join([make_label(node.items[0]), *(term.lstrip('?') if ground else term for term in terms)])})"

    def effects(self, node: Node, scope: Scope, guards: tuple[str, ...] = ()) -> list[str]:
        """An effect as a list of texts, none an `and`, each under the conditions (`guards`) that surround it."""
        result: list[str] = []
        simple: list[str] = []
        for part in self._conjuncts(node):
            if part.head == "when":
                self._expect(part, 2)
                guard = self.condition(part.items[1], scope)
                result += self.effects(part.items[2], scope, (*guards, guard))
            elif part.head == "forall":
                variables, inner = self._quantified(part, scope)
                repeated = self.effects(part.items[2], inner, guards)
                result += [f"(forall {variables} (and {' '.join(repeated)}))"]
            else:
                simple.append(self._simple_effect(part, scope))
        if guards and simple:
            return [*result, f"(when (and {' '.join(guards)}) (and {' '.join(simple)}))"]
        return result + simple

    def _conjuncts(self, node: Node) -> list[Group]:
        if isinstance(node, Symbol):
            raise self._source.mistake(node, f"{shown(node)} is not an effect", "one in parentheses")
        if node.head == "and":
            return [each for part in node.items[1:] for each in self._conjuncts(part)]
        return [node] if node.items else []

    def _simple_effect(self, node: Group, scope: Scope) -> str:
        if node.head == "not":
            self._expect(node, 1)
            return f"(not {self.atom(node.items[1], scope)})"
        if node.head not in ASSIGNMENTS:
            return self.atom(node, scope)
        self._expect(node, 2)
        target = node.items[1]
        if (isinstance(target, Symbol) and not target.is_name) or _is_arithmetic(target):
            raise self._source.mistake(target, f"cannot {node.head} {shown(target)}", "a numeric fluent")
        return f"({node.head} {self.expression(target, scope)} {self.expression(node.items[2], scope)})"

    def _quantified(self, node: Group, scope: Scope) -> tuple[str, dict[str, str]]:
        self._expect(node, 2)
        variables = node.items[1]
        if not isinstance(variables, Group):
            raise self._source.mistake(variables, f"{shown(variables)} after '{node.head}'", "'(?variable ...)'")
        return self.bind(variables.items, scope)

    def _expect(self, node: Group, count: int) -> None:
        if len(node.items) - 1 != count:
            raise self._source.mistake(node, f"'{node.head}' with {len(node.items) - 1} arguments", str(count))


def _is_arithmetic(node: Node) -> bool:
    """Whether a node is `(+ ...)` and the like, which cannot be assigned to."""
    return isinstance(node, Group) and node.head in ("+", "-", "*", "/", "")


def shown(node: Node) -> str:
    """A node in an error message."""
    if isinstance(node, Symbol):
        return f"'{node.text}'"
    return f"'({node.head} ...)'" if node.head else "'(...)'"
