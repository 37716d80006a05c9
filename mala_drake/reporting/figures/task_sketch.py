"""Where everything in the picture of a task goes: boxes, arrows and their texts, in inches, x to the right and y up."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.planning.syntax import Fact
from mala_drake.reporting.figures.label_places import Box, choose_boxes
from mala_drake.reporting.figures.layered_layout import LayeredLayout, layered_layout, layers_of
from mala_drake.reporting.figures.task_texts import TaskTexts
from mala_drake.reporting.task_graph import Edge, Part, TaskGraph

TYPE_SIZE, LABEL_SIZE = 6.0, 5.7
"""Points of the text in boxes and beside arrows."""

_CHARACTER = 0.0475  # Inches of a character in a box, about.
_LINE = 0.105  # Inches of a line.
_ROOM = 0.22  # Inches between two layers, beside the lines of the longest text between them.
_GAPS = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)  # Inches between neighbours in a layer: the first that fits is taken.
_BETWEEN_PARTS = 0.5  # Inches.
_BESIDE = 0.05  # Inches of a text from its arrow.
_ALONG = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74)  # Where on an arrow its text may be, as parts of its length.

Point = tuple[float, float]


@dataclass(frozen=True)
class Node:
    """A box with text. The beginnings and the goal are strong."""

    x: float
    y: float
    text: str
    strong: bool = False

    @property
    def width(self) -> float:
        """Inches."""
        return _width(self.text)

    @property
    def height(self) -> float:
        """Inches."""
        return _height(self.text)

    @property
    def box(self) -> Box:
        """Its outline."""
        x, y, half_width, half_height = self.x, self.y, self.width / 2, self.height / 2
        return x - half_width, y - half_height, x + half_width, y + half_height


@dataclass(frozen=True)
class Arrow:
    """A path with a head at its end, or at both.

    Attributes:
        path: at least two points.
        places: where its actions can be done.
        text: that belongs to it; empty when another arrow says the same.
        aside: whether it leads to a box in the same layer; it has no text then, for lack of room.
        both_ways: whether there is one back.
    """

    path: tuple[Point, ...]
    places: tuple[str, ...]
    text: str = ""
    aside: bool = False
    both_ways: bool = False

    def at(self, parts: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """The points at some parts of its length, shape (n, 2)."""
        corners = np.array(self.path)
        lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T)))
        return np.stack([np.interp(np.array(parts) * lengths[-1], lengths, axis) for axis in corners.T], axis=1)


@dataclass(frozen=True)
class Sketch:
    """A whole picture; `labels` has the box of the text of each arrow that has one, in the order of these arrows."""

    nodes: tuple[Node, ...]
    arrows: tuple[Arrow, ...]
    labels: tuple[Box, ...]

    @property
    def bounds(self) -> Box:
        """What holds everything."""
        boxes = np.array([*(node.box for node in self.nodes), *self.labels])
        (left, bottom), (right, top) = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        return float(left), float(bottom), float(right), float(top)


def sketch(graph: TaskGraph, texts: TaskTexts, *, width: float = math.inf) -> Sketch:
    """Parts beside each other, from top to bottom, and the goal under all of them.

    Args:
        graph: to be drawn.
        texts: what is written into it.
        width: that should not be exceeded, inches; it is when the boxes do not fit.
    """
    for gap in _GAPS:
        drawn = _sketch(graph, texts, gap)
        left, _, right, _ = drawn.bounds
        if right - left <= width:
            break
    return drawn


def _sketch(graph: TaskGraph, texts: TaskTexts, gap: float) -> Sketch:
    arranged = [_Arranged(part, texts, gap) for part in graph.parts]
    heights = _layer_heights(arranged)
    nodes: list[Node] = []
    arrows: list[Arrow] = []
    ready: list[Node] = []
    left = 0.0
    for part in arranged:
        own = part.nodes(left, heights)
        nodes += own
        ready += [own[number] for number in part.part.ready]
        arrows += part.arrows(own, heights)
        left = max(node.x + node.width / 2 for node in own) + _BETWEEN_PARTS
    text = texts.action(graph.goal_actions, graph.goal_places)
    goal = Node(sum(node.x for node in ready) / len(ready), heights[-1], "goal", strong=True)
    for node in ready:
        path = ((node.x, node.y - node.height / 2), (goal.x, goal.y + goal.height / 2))
        arrows.append(Arrow(path, graph.goal_places, text if node is ready[-1] else ""))
    nodes.append(goal)
    return Sketch(tuple(nodes), tuple(arrows), tuple(_label_boxes(nodes, arrows)))


class _Arranged:
    """A part with the texts and the layout of its nodes."""

    def __init__(self, part: Part, texts: TaskTexts, gap: float) -> None:
        self.part = part
        pairs = [(edge.source, edge.target) for edge in part.edges]
        self.layer = layers_of(len(part.nodes), pairs)
        gained: dict[int, set[Fact]] = defaultdict(set)
        for edge in part.edges:
            if self._down(edge):
                gained[edge.target] |= edge.gained
        self.names = [texts.facts(gained[i], states) if i else "start" for i, states in enumerate(part.nodes)]
        self.layout: LayeredLayout = layered_layout([_width(name) for name in self.names], pairs, gap=gap)
        self.texts = {(edge.source, edge.target): text for edge, text in self._edge_texts(texts)}

    def _down(self, edge: Edge) -> bool:
        return self.layer[edge.source] < self.layer[edge.target]

    def _edge_texts(self, texts: TaskTexts) -> Iterator[tuple[Edge, str]]:
        """The text of each edge; on the way up or aside, none for actions that have been named into the same node."""
        named: set[tuple[int, tuple[str, ...]]] = set()
        for edge in sorted(self.part.edges, key=lambda each: not self._down(each)):
            again = (edge.target, edge.actions) in named and not self._down(edge)
            named.add((edge.target, edge.actions))
            yield edge, "" if again else texts.action(edge.actions, edge.places)

    def nodes(self, left: float, heights: Sequence[float]) -> list[Node]:
        """The boxes, the leftmost of them at `left`."""
        positions = [x for x, _ in self.layout.positions]
        shift = left - min(x - _width(name) / 2 for x, name in zip(positions, self.names, strict=True))
        self._shift = shift
        return [
            Node(x + shift, heights[layer], name, strong=number == 0)
            for number, ((x, layer), name) in enumerate(zip(self.layout.positions, self.names, strict=True))
        ]

    def arrows(self, nodes: Sequence[Node], heights: Sequence[float]) -> Iterator[Arrow]:
        """The edges, between the boxes that `nodes` has made."""
        pairs = {(edge.source, edge.target) for edge in self.part.edges}
        for edge in self.part.edges:
            key = edge.source, edge.target
            source, target = nodes[edge.source], nodes[edge.target]
            if self.layer[edge.source] == self.layer[edge.target]:
                back = (edge.target, edge.source) in pairs
                if not (back and source.x > target.x):
                    yield Arrow(_aside(source, target, nodes), edge.places, aside=True, both_ways=back)
                continue
            down = 0.5 if self._down(edge) else -0.5
            bends = [(x + self._shift, heights[layer]) for x, layer in self.layout.bends[key]]
            start = (_end(source, bends[0] if bends else (target.x, target.y)), source.y - down * source.height)
            end = (_end(target, bends[-1] if bends else (source.x, source.y)), target.y + down * target.height)
            yield Arrow((start, *bends, end), edge.places, self.texts[key])


def _end(node: Node, towards: Point) -> float:
    """Where on the upper or lower side of a box an arrow ends: a little to the side that it comes from."""
    reach = 0.25 * node.width
    return node.x + min(max(0.3 * (towards[0] - node.x), -reach), reach)


def _aside(source: Node, target: Node, nodes: Sequence[Node]) -> tuple[Point, ...]:
    """The path between two boxes of a layer: straight between neighbours, else below what stands between them."""
    side = 0.5 if target.x > source.x else -0.5
    low, high = sorted((source.x, target.x))
    between = [node for node in nodes if node.y == source.y and low < node.x < high]
    if not between:
        return (source.x + side * source.width, source.y), (target.x - side * target.width, target.y)
    start, end = source.x + 0.6 * side * source.width, target.x - 0.6 * side * target.width
    bottom = min(node.y - node.height / 2 for node in (source, target, *between)) - 0.035 * (len(between) + 1)
    corners = ((start, bottom), (end, bottom))
    return (start, source.y - source.height / 2), *corners, (end, target.y - target.height / 2)


def _layer_heights(parts: Sequence[_Arranged]) -> list[float]:
    """The y of each layer and of the goal below them, with room for boxes and the texts between them."""
    layers = max(part.layout.layers for part in parts)
    box = [_height("goal")] * (layers + 1)
    lines = [0] * layers + [3]
    for part in parts:
        for number, name in zip(part.layer, part.names, strict=True):
            box[number] = max(box[number], _height(name))
        for (source, target), text in part.texts.items():
            upper, lower = sorted((part.layer[source], part.layer[target]))
            for between in range(upper, lower):
                lines[between + 1] = max(lines[between + 1], text.count("\n") + 1 if text else 0)
    heights = [0.0]
    for number in range(1, layers + 1):
        gap = _ROOM + _LINE * lines[number]
        heights.append(heights[-1] - box[number - 1] / 2 - gap - box[number] / 2)
    return heights


def _label_boxes(nodes: Sequence[Node], arrows: Sequence[Arrow]) -> list[Box]:
    """Room for the texts of the arrows, beside them."""
    points = np.concatenate([arrow.at(np.linspace(0.0, 1.0, 25)) for arrow in arrows])
    candidates = []
    for arrow in (arrow for arrow in arrows if arrow.text):
        width, height = _label_width(arrow.text), _LINE * (arrow.text.count("\n") + 1)
        leftward = arrow.path[-1][0] < arrow.path[0][0] - 0.05
        found = []
        for rank, (x, y) in enumerate(arrow.at(_ALONG)):
            for left in (leftward, not leftward):
                start = x - _BESIDE - width if left else x + _BESIDE
                found.append(
                    ((start, y - height / 2, start + width, y + height / 2), 0.05 * rank + 0.1 * (left != leftward))
                )
        candidates.append(found)
    return choose_boxes(candidates, obstacles=[node.box for node in nodes], points=points)


def _label_width(text: str) -> float:
    return _CHARACTER * LABEL_SIZE / TYPE_SIZE * max(map(len, text.split("\n")))


def _width(text: str) -> float:
    return 0.14 + _CHARACTER * max(map(len, text.split("\n")))


def _height(text: str) -> float:
    return 0.09 + _LINE * (text.count("\n") + 1)
