"""The picture of a task: every box and every edge is in it, and nothing covers anything else."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.reporting.figures.task_graphs import task_texts
from mala_drake.reporting.figures.task_sketch import sketch
from mala_drake.reporting.task_graph import task_graph
from mala_drake.ward.ward_map import LoadWard


@pytest.fixture(scope="module", params=TASK_NAMES)
def drawn(request):
    task = CareTask(request.param, LoadWard()).planning_task
    graph = task_graph(task)
    return graph, sketch(graph, task_texts(task, graph), width=7.4)


def covered(a, b):
    """The part of box a that b covers."""
    area = max(min(a[2], b[2]) - max(a[0], b[0]), 0.0) * max(min(a[3], b[3]) - max(a[1], b[1]), 0.0)
    return area / ((a[2] - a[0]) * (a[3] - a[1]))


def test_no_box_covers_another(drawn):
    _, picture = drawn
    assert all(covered(a.box, b.box) == 0.0 for a, b in combinations(picture.nodes, 2))


def test_texts_cover_neither_boxes_nor_each_other(drawn):
    _, picture = drawn
    assert max(covered(a, b) for a, b in combinations(picture.labels, 2)) < 0.05
    assert max(covered(label, node.box) for label in picture.labels for node in picture.nodes) < 0.1


def test_there_is_a_box_for_each_node_and_an_arrow_for_each_edge(drawn):
    graph, picture = drawn
    assert len(picture.nodes) == sum(len(part.nodes) for part in graph.parts) + 1
    edges = sum(len(part.edges) for part in graph.parts) + sum(len(part.ready) for part in graph.parts)
    assert sum(1 + arrow.both_ways for arrow in picture.arrows) == edges
    assert len(picture.labels) == sum(bool(arrow.text) for arrow in picture.arrows)


def test_arrows_end_at_boxes(drawn):
    _, picture = drawn
    boxes = np.array([node.box for node in picture.nodes])
    for arrow in picture.arrows:
        for x, y in (arrow.path[0], arrow.path[-1]):
            beyond = np.maximum(
                np.maximum(boxes[:, 0] - x, x - boxes[:, 2]), np.maximum(boxes[:, 1] - y, y - boxes[:, 3])
            )
            assert np.min(np.abs(beyond)) < 1e-9


def test_every_action_is_named_somewhere(drawn):
    graph, picture = drawn
    written = " ".join(arrow.text.replace("\n", " ") for arrow in picture.arrows)
    for part in graph.parts:
        for edge in part.edges:
            for action in edge.actions:
                assert all(word in written.split() for word in action.replace("_", " ").split())
