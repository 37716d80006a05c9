"""Names that remember which word of the file they stand for.

`pddl` keeps conjuncts, actions and initial facts in sets: equal ones merge, their order changes with the hash seed, and
no node knows its place in the file. So the text handed to it gives every occurrence of a name its own label,
`<kind><name>--<index>`, where index counts the words of the file. Nothing merges, sorting by index restores the order
of the file, numbers stay exact (the label leads back to the word), a name may even equal a keyword, and an error found
in the tree can name line and column.
"""

from __future__ import annotations

from mala_drake.planning.source import Source, Symbol

PLAIN = "n"  # A predicate, function, action or number.
VARIABLE = "v"
OBJECT = "o"


def make_label(symbol: Symbol, *, kind: str = PLAIN, name: str | None = None) -> str:
    """The label of `symbol`, under another name than its own if one is given."""
    text = symbol.text if name is None else name
    return f"{kind}{'number' if symbol.is_number else text.lstrip('?')}--{symbol.index}"


def label_name(label: str) -> str:
    """The name in a label; a variable's starts with `?`."""
    name = str(label)[1:].rpartition("--")[0]
    return "?" + name if str(label)[0] == VARIABLE else name


def label_index(label: str) -> int:
    """Where in the file the labelled word stands: sort by it to get the order of the file."""
    return int(str(label).rpartition("--")[2])


def labelled_symbol(source: Source, label: str) -> Symbol:
    """The word of the file that a label stands for."""
    return source.symbols[label_index(label)]


def type_label(name: str) -> str:
    """Types carry no index, only a prefix that keeps them apart from keywords."""
    return f"type--{name}"


def type_name(label: str) -> str:
    """The type in a type label."""
    return str(label).removeprefix("type--")
