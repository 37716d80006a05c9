"""A PDDL file as nested groups of symbols that know their line and column."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from mala_drake.errors import BadInput

_TOKEN = re.compile(r"[()]|;[^\n]*|[^\s();]+")
_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d{1,3})?")
# Levels of parentheses. Real files have about ten; each may take Python seven levels of recursion, of a thousand.
_DEEPEST = 100


@dataclass(frozen=True, slots=True)
class Symbol:
    """One word of the file in lower case (PDDL ignores case); `index` counts the words of the file."""

    text: str
    index: int
    line: int
    column: int

    @property
    def is_variable(self) -> bool:
        """Whether this is `?name`."""
        return self.text.startswith("?") and _NAME.fullmatch(self.text[1:]) is not None

    @property
    def is_name(self) -> bool:
        """Whether this is a legal PDDL name."""
        return _NAME.fullmatch(self.text) is not None

    @property
    def is_number(self) -> bool:
        """Whether this is a decimal number, with an optional sign and exponent."""
        return _NUMBER.fullmatch(self.text) is not None

    @property
    def number(self) -> Fraction:
        """The exact value of a number."""
        return Fraction(self.text)


@dataclass(frozen=True, slots=True)
class Group:
    """A pair of parentheses and what is between them."""

    items: tuple[Node, ...]
    line: int
    column: int

    @property
    def head(self) -> str:
        """The first word, or the empty string if there is none."""
        return self.items[0].text if self.items and isinstance(self.items[0], Symbol) else ""


Node = Symbol | Group


@dataclass(frozen=True, slots=True)
class Source:
    """A parsed file: its name for messages, its only top-level group and all its words by index."""

    name: str
    root: Group
    symbols: tuple[Symbol, ...]

    def place(self, node: Node) -> str:
        """`file:line:column` of a node."""
        return f"{self.name}:{node.line}:{node.column}"

    def mistake(self, node: Node, what: str, expected: str = "") -> BadInput:
        """The error to raise for something wrong at `node`."""
        return BadInput(self.place(node), what, expected)


def read_text(path: str | Path) -> str:
    """The text of a PDDL file.

    Raises:
        BadInput: if the file cannot be read or is not text.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise BadInput(str(path), f"cannot be read ({error.strerror or error})", "a PDDL file") from None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise BadInput(str(path), "is not a text file", "a PDDL file")
    return text


def parse_source(text: str, *, name: str) -> Source:
    """Splits `text` into groups and symbols.

    Raises:
        BadInput: if the text is empty or its parentheses do not match.
    """
    symbols: list[Symbol] = []
    finished: list[Node] = []
    open_groups: list[tuple[list[Node], int, int]] = []
    items = finished
    line, position = 1, 0
    for match in _TOKEN.finditer(text):
        line += text.count("\n", position, match.start())
        position = match.start()
        column = position - text.rfind("\n", 0, position)
        word = match.group()
        if word.startswith(";"):
            continue
        if word == "(":
            open_groups.append((items, line, column))
            items = []
            if len(open_groups) > _DEEPEST:
                raise BadInput(f"{name}:{line}:{column}", f"parentheses nested more than {_DEEPEST} deep")
        elif word == ")":
            if not open_groups:
                raise BadInput(f"{name}:{line}:{column}", "')' without a matching '('")
            outer, start_line, start_column = open_groups.pop()
            outer.append(Group(tuple(items), start_line, start_column))
            items = outer
        else:
            symbol = Symbol(word.lower(), len(symbols), line, column)
            symbols.append(symbol)
            items.append(symbol)
    if open_groups:
        _, line, column = open_groups[-1]
        raise BadInput(f"{name}:{line}:{column}", "'(' is never closed")
    return Source(name, _only_group(finished, name), tuple(symbols))


def _only_group(nodes: list[Node], name: str) -> Group:
    if not nodes:
        raise BadInput(name, "is empty", "a PDDL file starting with '(define'")
    first = nodes[0]
    if not isinstance(first, Group) or first.head != "define":
        raise BadInput(f"{name}:{first.line}:{first.column}", "not a PDDL definition", "'(define ...'")
    if len(nodes) > 1:
        extra = nodes[1]
        place = f"{name}:{extra.line}:{extra.column}"
        raise BadInput(place, "text after the end of the definition", "one definition a file")
    return first
