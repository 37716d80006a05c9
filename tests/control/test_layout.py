from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.control.layout as mut
from mala_drake.control.model import StateIndex
from mala_drake.control.parameters import (
    ConstraintParameters,
    MpcParameters,
    StageParameters,
    TerminalParameters,
)
from mala_drake.messages import Shape

N = 5
LAYOUT = mut.ParameterLayout(N, 2)


def make(yaw, **constraints):
    states = np.zeros((N + 1, 6))
    states[:, StateIndex.YAW] = yaw
    return MpcParameters(
        TerminalParameters(states[-1]),
        StageParameters(states[:-1]),
        ConstraintParameters(np.arange(1.0, N + 1), **constraints),
    )


def pieces(vector):
    return LAYOUT.split(vector, lambda piece, shape: piece.reshape(shape))


def test_packing_puts_every_group_where_the_names_say():
    shape = Shape("box", 1.0, 2.0, np.pi / 2, 0.3, 0.2, 0.1)
    found = pieces(LAYOUT.pack(np.zeros(6), make(np.zeros(N + 1), obstacles=(shape,), clearance=0.2)))
    np.testing.assert_allclose(found["constraints.speed_limits"], [1, 2, 3, 4, 5])
    np.testing.assert_allclose(found["constraints.required_distance"], 0.48)
    np.testing.assert_allclose(found["constraints.obstacles"][0], [1, 2, 0, 1, 0.3, 0.2, 0.1], atol=1e-15)
    np.testing.assert_allclose(found["stage.state_weights"], [34, 34, 3, 10.4, 10.4, 10.4])
    np.testing.assert_allclose(found["dynamics"], [5, 0, 0, 1, 1, 1])


def test_the_slices_tile_the_vector():
    places = list(LAYOUT.slices.values())
    assert places[0].start == 0
    assert all(a.stop == b.start for a, b in pairwise(places))
    assert places[-1].stop == LAYOUT.size


angles = st.floats(-20, 20)


@given(angles, st.lists(angles, min_size=N + 1, max_size=N + 1))
def test_yaw_references_keep_their_direction_and_come_within_half_a_turn(present, yaw):
    state = np.zeros(6)
    state[StateIndex.YAW] = present
    found = pieces(LAYOUT.pack(state, make(np.array(yaw))))
    unwrapped = np.append(found["stage.references"][:, StateIndex.YAW], found["terminal.target"][StateIndex.YAW])
    turns = (unwrapped - yaw) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    assert (np.abs(np.diff(np.append(present, unwrapped))) <= np.pi + 1e-9).all()


def test_with_too_many_obstacles_those_near_the_references_count():
    shapes = tuple(Shape(str(i), float(at), 0.0, radius=0.1) for i, at in enumerate((9.0, 1.0, -2.0, 20.0)))
    found = pieces(LAYOUT.pack(np.zeros(6), make(np.zeros(N + 1), obstacles=shapes)))
    np.testing.assert_allclose(found["constraints.obstacles"][:, 0], [1.0, -2.0])
