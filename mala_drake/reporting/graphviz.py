"""The diagram as Graphviz source: Drake's own, tidied up."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import groupby, zip_longest

from pydrake.systems.framework import Diagram

# Lines that start otherwise are parts of labels and may hold any name.
_NODE_LINE = re.compile(r"digraph _\d|subgraph cluster|s\d")
_EDGE_LINE = re.compile(r"s\d+\w*:\w+:e -> ")
_NODE = re.compile(r"\b(_|clusters?|s)(\d+)(?=\b|diagram|in\b|out\b|subsystems)")
_END = re.compile(r"\b(s\d+):([uy]\d+):[ew]")
_SYSTEM = re.compile(r"(s\d+) \[shape=none")
_CELL = re.compile(r"<TD PORT=\"([uy]\d+)\"[^>]*>(.*)</TD>")
_ROW_TAG = re.compile(r"</?TR>")
_MODULE = re.compile(r"<B>(?:\w+\.)+(\w+)</B>")


def graphviz_source(diagram: Diagram, max_depth: int | None = None) -> str:
    """Drake's Graphviz text, made to depend on the diagram alone and to be read.

    Drake numbers the nodes by a count of all systems that the process ever built, and orders edges by memory address.
    Ports that nothing is connected to are left out, for a plant has hundreds, and so are the modules of classes.
    """
    lines = list(_renumbered(diagram.GetGraphvizString(max_depth).splitlines()))
    connected = {end for line in lines if _EDGE_LINE.match(line) for end in _END.findall(line)}
    lines = [_MODULE.sub(r"<B>\1</B>", line) for line in _with_ports(lines, connected)]
    blocks = [list(block) for _, block in groupby(lines, key=lambda line: bool(_EDGE_LINE.match(line)))]
    return "".join(f"{line}\n" for block in blocks for line in (sorted(block) if _EDGE_LINE.match(block[0]) else block))


def _renumbered(lines: Iterable[str]) -> Iterator[str]:
    """Nodes numbered in the order of their appearance."""
    numbers: dict[str, int] = {}

    def number(match: re.Match[str]) -> str:
        return f"{match[1]}{numbers.setdefault(match[2], len(numbers) + 1)}"

    return (_NODE.sub(number, line) if _NODE_LINE.match(line) else line for line in lines)


def _with_ports(lines: Iterable[str], connected: set[tuple[str, str]]) -> Iterator[str]:
    """The lines, with the tables of systems rebuilt from the ports that are `connected`."""
    node = ""
    cells: dict[str, list[str]] = {"u": [], "y": []}
    for line in lines:
        if start := _SYSTEM.match(line):
            node, cells = start[1], {"u": [], "y": []}
        if node and (cell := _CELL.match(line)):
            if (node, cell[1]) in connected:
                cells[cell[1][0]].append(f'<TD PORT="{cell[1]}" BORDER="1">{cell[2]}</TD>')
        elif node and _ROW_TAG.fullmatch(line):
            continue
        elif node and line == "</TABLE>":
            for pair in zip_longest(cells["u"], cells["y"], fillvalue="<TD></TD>"):
                yield "<TR>" + "".join(pair) + "</TR>"
            node = ""
            yield line
        else:
            yield line
