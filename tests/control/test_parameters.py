import copy

import numpy as np
import pytest

import mala_drake.control.parameters as mut
from mala_drake.errors import BadInput
from mala_drake.messages import Shape


def make(stages=3, limits=3):
    return mut.MpcParameters(
        mut.TerminalParameters(np.zeros(6)),
        mut.StageParameters(np.zeros((stages, 6))),
        mut.ConstraintParameters(np.full(limits, 1.5)),
    )


def test_the_defaults_are_the_working_point_of_the_case():
    p = make()
    np.testing.assert_allclose(p.stage.state_weights, [34, 34, 3, 10.4, 10.4, 10.4])
    np.testing.assert_allclose(p.stage.control_weights, [3.05, 3.05, 2.35])
    np.testing.assert_allclose(p.terminal.weights, 100 * p.stage.state_weights)
    np.testing.assert_allclose(p.inputs.lower, [-2, 0, -1])
    np.testing.assert_allclose(p.inputs.upper, [2, 2, 1])
    assert p.dynamics.lateral_coupling == p.dynamics.yaw_coupling == 0
    assert p.horizon == 3


def test_arrays_are_copies_that_nobody_can_change():
    target = np.zeros(6)
    terminal = mut.TerminalParameters(target)
    target[0] = 5.0
    assert terminal.target[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        terminal.target[0] = 1.0


def test_a_deep_copy_is_the_value_itself():
    p = make()
    assert copy.deepcopy(p) is p


@pytest.mark.parametrize(
    "build",
    [
        lambda: mut.TerminalParameters(np.zeros(5)),
        lambda: mut.TerminalParameters(np.full(6, np.nan)),
        lambda: mut.TerminalParameters(np.zeros(6), -np.ones(6)),
        lambda: mut.StageParameters(np.zeros((3, 5))),
        lambda: mut.StageParameters(np.zeros((3, 6)), control_weights=np.zeros(3)),
        lambda: mut.DynamicsParameters(lateral_damping=20.0),
        lambda: mut.DynamicsParameters(brake_gain=0.0),
        lambda: mut.DynamicsParameters(yaw_coupling=np.inf),
        lambda: mut.ConstraintParameters(np.array([1.5, -1.0])),
        lambda: mut.ConstraintParameters(np.ones(3), clearance=np.nan),
        lambda: mut.ConstraintParameters(np.ones(3), obstacles=(Shape("broken", np.nan),)),
        lambda: mut.InputParameters(np.ones(3), np.zeros(3)),
        lambda: make(stages=3, limits=4),
    ],
)
def test_values_that_make_no_problem_are_refused(build):
    with pytest.raises(BadInput):
        build()
