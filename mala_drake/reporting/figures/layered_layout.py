"""Draws a directed graph in layers from top to bottom (Sugiyama, Tagawa and Toda 1981).

Layers come from longest paths, where a cycle counts as one piece that is laid out by the distance from where it is
entered. Edges over several layers bend at invisible nodes, layers are ordered by barycenters, and each node stands
under the mean of its neighbours above as far as the widths of the nodes let it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from mala_drake.reporting.figures.curves import spaced_by_widths

_ORDER_SWEEPS = 12
_BEND_WIDTH = 0.7  # Of the room for an edge that passes a layer, in units of the widths.


@dataclass(frozen=True)
class LayeredLayout:
    """Where everything is.

    Attributes:
        positions: of the nodes: x in the unit of their widths, and the number of the layer, 0 on top.
        bends: for each edge the positions between its ends, from source to target.
        layers: how many there are.
    """

    positions: tuple[tuple[float, int], ...]
    bends: Mapping[tuple[int, int], tuple[tuple[float, int], ...]]
    layers: int


def layered_layout(widths: Sequence[float], edges: Sequence[tuple[int, int]], *, gap: float = 0.15) -> LayeredLayout:
    """Lays out a graph whose nodes can all be reached from node 0.

    Args:
        widths: of the nodes.
        edges: pairs of numbers of nodes, sorted, without loops.
        gap: between neighbours in a layer.
    """
    layer = layers_of(len(widths), edges)
    all_widths, chains = list(widths), {}
    for source, target in edges:
        step = 1 if layer[target] > layer[source] else -1
        bends = []
        for between in range(layer[source] + step, layer[target], step):
            bends.append(len(all_widths))
            all_widths.append(_BEND_WIDTH)
            layer.append(between)
        chains[source, target] = bends
    neighbours: dict[int, list[int]] = defaultdict(list)
    for (source, target), bends in chains.items():
        path = [source, *bends, target]
        for a, b in pairwise(path):
            if layer[a] != layer[b]:
                neighbours[a].append(b)
                neighbours[b].append(a)
    rows = [[node for node in range(len(layer)) if layer[node] == each] for each in range(max(layer) + 1)]
    _order(rows, neighbours, layer)
    x = _move(rows, neighbours, all_widths, gap)
    return LayeredLayout(
        tuple((x[node], layer[node]) for node in range(len(widths))),
        {edge: tuple((x[bend], layer[bend]) for bend in bends) for edge, bends in chains.items()},
        len(rows),
    )


def layers_of(count: int, edges: Sequence[tuple[int, int]]) -> list[int]:
    """The layer of each of `count` nodes."""
    following: dict[int, list[int]] = defaultdict(list)
    for source, target in edges:
        following[source].append(target)
    layer = [0] * count
    for component in _components(count, following):  # In topological order.
        inside = set(component)
        incoming = [(source, target) for source, target in edges if target in inside and source not in inside]
        top = max((layer[source] + 1 for source, _ in incoming), default=0)
        entries = sorted({target for _, target in incoming}) or component[:1]
        for node in component:
            layer[node] = top
        reached, queue = set(entries), list(entries)
        for node in queue:
            for after in following[node]:
                if after in inside and after not in reached:
                    reached.add(after)
                    queue.append(after)
                    layer[after] = layer[node] + 1
    return layer


def _components(count: int, following: Mapping[int, Sequence[int]]) -> list[list[int]]:
    """Strongly connected components, each sorted, sources first (Kosaraju, for graphs small enough for recursion)."""
    finished: list[int] = []
    preceding: dict[int, list[int]] = defaultdict(list)
    for source, targets in following.items():
        for target in targets:
            preceding[target].append(source)

    def visit(node: int, edges: Mapping[int, Sequence[int]], seen: set[int], found: list[int]) -> None:
        seen.add(node)
        for after in edges.get(node, ()):
            if after not in seen:
                visit(after, edges, seen, found)
        found.append(node)

    seen: set[int] = set()
    for node in range(count):
        if node not in seen:
            visit(node, following, seen, finished)
    seen.clear()
    components = []
    for node in reversed(finished):
        if node not in seen:
            found: list[int] = []
            visit(node, preceding, seen, found)
            components.append(sorted(found))
    return components


def _order(rows: list[list[int]], neighbours: Mapping[int, Sequence[int]], layer: Sequence[int]) -> None:
    """Orders each layer by the mean place of the neighbours in the layer before, down and up in turn."""
    for sweep in range(_ORDER_SWEEPS):
        down = sweep % 2 == 0
        for number in range(1, len(rows)) if down else range(len(rows) - 2, -1, -1):
            fixed = number - 1 if down else number + 1
            place = {node: i for i, node in enumerate(rows[fixed])}
            center = {node: float(i) for i, node in enumerate(rows[number])}
            for node in rows[number]:
                places = [place[other] for other in neighbours[node] if layer[other] == fixed]
                if places:
                    center[node] = sum(places) / len(places)
            rows[number].sort(key=center.__getitem__)  # Stable, so that ties stay as they were.


def _move(
    rows: list[list[int]], neighbours: Mapping[int, Sequence[int]], widths: Sequence[float], gap: float
) -> dict[int, float]:
    """Puts each node under the mean of its neighbours above, which keeps chains straight, as far as widths allow."""
    x: dict[int, float] = {}
    for row in rows:
        above = [[x[other] for other in neighbours[node] if other in x] for node in row]
        wanted = [sum(places) / len(places) if places else 0.0 for places in above]
        x.update(zip(row, spaced_by_widths(wanted, [widths[node] + gap for node in row]), strict=True))
    return x
