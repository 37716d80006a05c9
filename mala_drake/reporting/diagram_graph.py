"""The diagram as a picture: Graphviz source, Mermaid for Markdown, or an image."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import TypeGuard

from pydrake.systems.framework import Diagram, InputPortIndex, OutputPortIndex, System

from mala_drake.errors import BadInput

FORMATS = (".dot", ".md", ".svg", ".png")

_NODE_LINE = re.compile(r"digraph _\d|subgraph cluster|s\d")
_EDGE_LINE = re.compile(r"s\d+\w*:\w+:e -> ")
_NODE = re.compile(r"\b(_|clusters?|s)(\d+)(?=\b|diagram|in\b|out\b|subsystems)")

_Port = tuple[str, str]  # Node and port name.


def write_graph(diagram: Diagram, path: str | Path, max_depth: int | None = None) -> Path:
    """Writes the graph of a diagram's systems and connections; the same diagram gives the same text.

    Args:
        diagram: any diagram.
        path: its suffix selects the form: .dot, .md (Mermaid), .svg or .png.
        max_depth: how many levels of nested diagrams are opened; None opens all.

    Returns:
        The path.

    Raises:
        BadInput: for another suffix, a negative depth, a file that cannot be written, or a picture when Graphviz'
            `dot` is not installed.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise BadInput(str(path), f"no such form {suffix!r}", "a file name ending in " + ", ".join(FORMATS))
    if max_depth is not None and max_depth < 0:
        raise BadInput("max_depth", f"{max_depth}", "0 or more levels")
    if suffix == ".md":
        content = f"# {diagram.get_name() or 'Diagram'}\n\n```mermaid\n{mermaid(diagram, max_depth)}```\n".encode()
    else:
        source = graphviz_source(diagram, max_depth)
        content = source.encode() if suffix == ".dot" else _drawn(source, suffix[1:], path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise BadInput(str(path), f"cannot be written ({error.strerror})", "a writable file") from None
    return path


def graphviz_source(diagram: Diagram, max_depth: int | None = None) -> str:
    """Drake's own Graphviz text, made to depend on the diagram alone.

    Drake numbers the nodes by a count of all systems that the process ever built, and orders edges by memory address.
    """
    numbers: dict[str, int] = {}

    def renumbered(match: re.Match[str]) -> str:
        return f"{match[1]}{numbers.setdefault(match[2], len(numbers) + 1)}"

    lines = diagram.GetGraphvizString(max_depth).splitlines()
    # Other lines are parts of labels and may hold any name.
    lines = [_NODE.sub(renumbered, line) if _NODE_LINE.match(line) else line for line in lines]
    blocks = [list(block) for _, block in groupby(lines, key=lambda line: bool(_EDGE_LINE.match(line)))]
    return "".join(f"{line}\n" for block in blocks for line in (sorted(block) if _EDGE_LINE.match(block[0]) else block))


def mermaid(diagram: Diagram, max_depth: int | None = None) -> str:
    """A Mermaid flowchart: systems are nodes with their class below, nested diagrams boxes; edges carry port names."""
    lines = [*_nodes(diagram, "d", max_depth, 1), *_exports(diagram, max_depth), *_edges(diagram, max_depth)]
    return "\n".join(["flowchart LR", *lines]) + "\n"


def _class_name(system: System) -> str:
    return type(system).__name__.removesuffix("_").removesuffix("_[float]")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', "#quot;") + '"'


def _opened(system: System, depth: int | None) -> TypeGuard[Diagram]:
    """Whether the system is a diagram whose inside is drawn when `depth` more levels may be."""
    return isinstance(system, Diagram) and depth != 0


def _less(depth: int | None) -> int | None:
    return None if depth is None else depth - 1


def _nodes(diagram: Diagram, node: str, depth: int | None, indent: int) -> Iterator[str]:
    space = "    " * indent
    if not _opened(diagram, depth):
        yield f"{space}{node}[{_quoted(diagram.get_name() or 'diagram')}]"
        return
    for i, system in enumerate(diagram.GetSystems()):
        child = f"{node}_{i}"
        if _opened(system, _less(depth)):
            yield f"{space}subgraph {child}[{_quoted(system.get_name())}]"
            yield from _nodes(system, child, _less(depth), indent + 1)
            yield f"{space}end"
        else:
            yield f"{space}{child}[{_quoted(f'{system.get_name()}<br/><small>{_class_name(system)}</small>')}]"


def _exports(diagram: Diagram, depth: int | None) -> Iterator[str]:
    """The ports of the whole diagram, as nodes of their own."""
    if not _opened(diagram, depth):
        return
    for i in range(diagram.num_input_ports()):
        yield f"    in_{i}([{_quoted(diagram.get_input_port(i).get_name())}])"
    for i in range(diagram.num_output_ports()):
        yield f"    out_{i}([{_quoted(diagram.get_output_port(i).get_name())}])"


def _edges(diagram: Diagram, depth: int | None) -> Iterator[str]:
    """One edge a pair of nodes, which carries the names of all its ports."""
    if not _opened(diagram, depth):
        return
    labels: dict[tuple[str, str], set[str]] = {}
    for (source, source_port), (target, target_port) in _connections(diagram, "d", depth):
        label = source_port if source_port == target_port else f"{source_port} → {target_port}"
        labels.setdefault((source, target), set()).add(label)
    for i in range(diagram.num_input_ports()):
        for target, target_port in _targets(diagram, i, "d", depth):
            labels.setdefault((f"in_{i}", target), set()).add(target_port)
    for i in range(diagram.num_output_ports()):
        source, source_port = _source(diagram, i, "d", depth)
        labels.setdefault((source, f"out_{i}"), set()).add(source_port)
    for (source, target), texts in sorted(labels.items()):
        yield f"    {source} -->|{_quoted('<br/>'.join(sorted(texts)))}| {target}"


def _connections(diagram: Diagram, node: str, depth: int | None) -> Iterator[tuple[_Port, _Port]]:
    """All connections between drawn nodes, inside nested diagrams too."""
    children = _children(diagram, node)
    for (target, target_port), (source, source_port) in diagram.connection_map().items():
        source_end = _source(source, source_port, children[source.get_name()], _less(depth))
        for target_end in _targets(target, target_port, children[target.get_name()], _less(depth)):
            yield source_end, target_end
    for system in diagram.GetSystems():
        if _opened(system, _less(depth)):
            yield from _connections(system, children[system.get_name()], _less(depth))


def _children(diagram: Diagram, node: str) -> dict[str, str]:
    """The nodes of a diagram's systems, whose names are unique in it."""
    return {system.get_name(): f"{node}_{i}" for i, system in enumerate(diagram.GetSystems())}


def _source(system: System, port: int, node: str, depth: int | None) -> _Port:
    """The drawn node and port behind an output port."""
    if not _opened(system, depth):
        return node, system.get_output_port(port).get_name()
    inner, inner_port = system.get_output_port_locator(OutputPortIndex(int(port)))
    return _source(inner, inner_port, _children(system, node)[inner.get_name()], _less(depth))


def _targets(system: System, port: int, node: str, depth: int | None) -> Iterator[_Port]:
    """The drawn nodes and ports that an input port feeds."""
    if not _opened(system, depth):
        yield node, system.get_input_port(port).get_name()
        return
    for inner, inner_port in system.GetInputPortLocators(InputPortIndex(int(port))):
        yield from _targets(inner, inner_port, _children(system, node)[inner.get_name()], _less(depth))


def _drawn(source: str, form: str, path: Path) -> bytes:
    program = shutil.which("dot")
    if program is None:
        raise BadInput(
            str(path),
            "drawing needs Graphviz' program `dot`, which is not on the PATH",
            "Graphviz to be installed, or a file name ending in .md or .dot",
        )
    done = subprocess.run([program, f"-T{form}"], input=source.encode(), capture_output=True, check=False)
    if done.returncode != 0:
        reason = done.stderr.decode(errors="replace").strip().splitlines()
        raise BadInput(str(path), f"`dot` failed ({reason[-1] if reason else done.returncode})", "a graph it can draw")
    return done.stdout
