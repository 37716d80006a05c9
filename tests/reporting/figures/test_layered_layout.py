"""Graphs in layers: what leads on leads down, and nothing stands on anything else."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from mala_drake.reporting.figures import layered_layout as mut

SIZE = 7
pairs = st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1)).filter(lambda pair: pair[0] != pair[1])


@st.composite
def graphs(draw):
    """A graph whose nodes can all be reached from node 0."""
    edges = sorted(
        draw(st.sets(pairs, min_size=1, max_size=16)) | {(draw(st.integers(0, i - 1)), i) for i in range(1, SIZE)}
    )
    matrix = coo_array((np.ones(len(edges)), np.array(edges).T), shape=(SIZE, SIZE)).tocsr()
    assume(len(breadth_first_order(matrix, 0)[0]) == SIZE)
    return edges, connected_components(matrix, connection="strong")[1]


@given(graph=graphs())
def test_edges_out_of_a_cycle_lead_down(graph):
    edges, component = graph
    layer = mut.layers_of(SIZE, edges)
    assert min(layer) == 0
    assert all(layer[a] < layer[b] for a, b in edges if component[a] != component[b])


@given(graph=graphs(), widths=st.lists(st.floats(0.1, 3.0), min_size=SIZE, max_size=SIZE))
def test_neighbours_in_a_layer_keep_their_distance(graph, widths):
    edges, _ = graph
    layout = mut.layered_layout(widths, edges, gap=0.2)
    for layer in range(layout.layers):
        row = sorted((x, width) for (x, own), width in zip(layout.positions, widths, strict=True) if own == layer)
        for (left, a), (right, b) in pairwise(row):
            assert right - left >= (a + b) / 2 + 0.2 - 1e-9


@given(graph=graphs())
def test_long_edges_bend_once_in_each_layer_that_they_pass(graph):
    edges, _ = graph
    layout = mut.layered_layout([1.0] * SIZE, edges)
    for source, target in edges:
        layers = [
            layout.positions[source][1],
            *(layer for _, layer in layout.bends[source, target]),
            layout.positions[target][1],
        ]
        assert all(abs(b - a) == 1 for a, b in pairwise(layers)) or layers[0] == layers[-1]


def test_a_chain_is_straight_and_a_fork_is_even():
    layout = mut.layered_layout([1.0] * 5, [(0, 1), (1, 2), (1, 3), (2, 4)], gap=0.5)
    assert layout.positions == ((0.0, 0), (0.0, 1), (-0.75, 2), (0.75, 2), (-0.75, 3))


def test_a_cycle_is_laid_out_from_where_it_is_entered():
    assert mut.layers_of(4, [(0, 1), (1, 2), (2, 3), (3, 1)]) == [0, 1, 2, 3]
    assert mut.layers_of(3, [(0, 1), (0, 2), (1, 2), (2, 1)]) == [0, 1, 1]
