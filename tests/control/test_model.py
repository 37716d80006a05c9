import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import mala_drake.control.model as mut

PERIOD = 0.2
NOMINAL = np.array([5.0, 0.0, 0.0, 1.0, 1.0, 1.0])
LEARNED = np.array([5.0, 0.3, 0.2, 0.97, 1.04, 0.9])

moderate = st.floats(-1.5, 1.5)
states = st.tuples(*[moderate] * 6).map(np.array)
controls = st.tuples(moderate, st.floats(0, 2), st.floats(-1, 1)).map(np.array)
dynamics = st.sampled_from([NOMINAL, LEARNED])


def truth(z, u, p):
    """The equations of the case, written again in numpy."""
    k, g, c, propulsion_gain, brake_gain, yaw_gain = p
    _, _, yaw, v_x, v_y, omega = z
    return np.array(
        [
            v_x * np.cos(yaw) - v_y * np.sin(yaw),
            v_x * np.sin(yaw) + v_y * np.cos(yaw),
            omega,
            propulsion_gain * u[0] - brake_gain * u[1],
            -k * v_y + g * v_x * omega,
            yaw_gain * u[2] - c * v_x * omega,
        ]
    )


def runge_kutta(z, u, p):
    a = truth(z, u, p)
    b = truth(z + PERIOD / 2 * a, u, p)
    c = truth(z + PERIOD / 2 * b, u, p)
    d = truth(z + PERIOD * c, u, p)
    return z + PERIOD / 6 * (a + 2 * b + 2 * c + d)


STEP = mut.step_function(PERIOD)


def step(z, u, p):
    return STEP(z, u, p).full()[:, 0]


@given(states, controls, dynamics)
def test_a_step_is_the_runge_kutta_step_of_the_equations_of_the_case(z, u, p):
    np.testing.assert_allclose(step(z, u, p), runge_kutta(z, u, p), atol=1e-12)


@given(states, controls, dynamics)
def test_a_step_follows_the_exact_flow(z, u, p):
    exact = solve_ivp(lambda _, y: truth(y, u, p), (0, PERIOD), z, rtol=1e-10, atol=1e-12).y[:, -1]
    error = np.abs(step(z, u, p) - exact)
    # The lateral mode decays by e^-1 a step, of which the fourth-order series misses 2 %.
    slip = abs(z[4]) + abs(z[3] * z[5])
    assert error.max() <= 1e-3 + 0.03 * slip


def test_the_robot_rolls_where_it_looks_and_turns_left_for_positive_yaw_acceleration():
    z = np.array([1.0, 2.0, np.pi / 2, 1.0, 0.0, 0.0])
    after = step(z, np.array([0.0, 0.0, 1.0]), NOMINAL)
    assert after[1] == pytest.approx(2.2, abs=1e-3)
    assert after[2] > z[2]
    assert after[0] < 1.0  # Left of north is west.


def test_a_gyroscopic_coefficient_slows_the_turn_and_pushes_sideways():
    z, u = np.array([0, 0, 0, 1.0, 0, 1.0]), np.zeros(3)
    after = step(z, u, np.array([5.0, 0.5, 0.5, 1.0, 1.0, 1.0]))
    assert after[5] < 1.0
    assert after[4] > 0.0


def test_the_strongest_admitted_lateral_damping_is_stable():
    p = NOMINAL.copy()
    p[mut.DynamicsIndex.LATERAL_DAMPING] = 12.0
    z = np.array([0, 0, 0, 0, 1.0, 0])
    for _ in range(50):
        z = step(z, np.zeros(3), p)
    assert abs(z[4]) < 1e-3


def test_the_model_evaluates_symbols():
    z, u, p = (casadi.SX.sym(n, s) for n, s in (("z", 6), ("u", 3), ("p", 6)))
    jacobian = casadi.Function("j", [z, u, p], [casadi.jacobian(mut.derivative(z, u, p), u)])
    np.testing.assert_allclose(
        jacobian(np.zeros(6), np.zeros(3), LEARNED).full(),
        [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0.97, -1.04, 0], [0, 0, 0], [0, 0, 0.9]],
    )
