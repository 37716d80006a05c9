"""The diagram as a Mermaid flowchart, which Markdown viewers draw."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from pydrake.systems.framework import Diagram, InputPortIndex, OutputPortIndex, System

_Port = tuple[str, str]  # Node and port name.


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
