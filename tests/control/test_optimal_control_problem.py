import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.control.optimal_control_problem as mut
from mala_drake.buffered_function import BufferedFunction
from mala_drake.control.shooting import LIMITS
from mala_drake.errors import BadInput
from mala_drake.messages import Shape
from mala_drake.ward.shapes import ShapeDistances

BOX = Shape("box", 1.2, 0.3, 0.4, 0.3, 0.2, 0.05)
seeds = st.integers(0, 10_000)


def random_controls(seed):
    return np.random.default_rng(seed).uniform((-2, 0, -1), (2, 2, 1), (20, 3))


def evaluate(problem, controls, state, parameters):
    cost, gradient = problem.cost_and_gradient(controls.T, state, problem.pack(state, parameters))
    return float(cost), gradient.full().T


def cost_by_the_book(problem, controls, state, parameters):
    """The cost of the case, summed stage by stage in numpy, with wrapped yaw errors."""

    def hinge(excess, width):
        return np.where(excess < width, np.maximum(excess, 0) ** 2 / (2 * width), excess - width / 2)

    def wrapped(error):
        error = error.copy()
        error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
        return error

    z = problem.rollout(state, controls, parameters)
    stage, bounds = parameters.stage, parameters.constraints
    total = sum(
        wrapped(x - r) ** 2 @ stage.state_weights for x, r in zip(z[:-1], stage.references, strict=True)
    ) + np.sum(controls**2 @ stage.control_weights)
    total += wrapped(z[-1] - parameters.terminal.target) ** 2 @ parameters.terminal.weights
    if bounds.obstacles:
        margins = ShapeDistances(bounds.obstacles)(z[1:, :2]) - bounds.robot_radius - bounds.clearance
        total += bounds.obstacle_penalty * hinge(0.04 - margins, 0.04).sum()
    v, omega = z[1:, 3], z[1:, 5]
    limits = (
        bounds.speed_limits - v,
        bounds.reverse_limit + v,
        bounds.yaw_rate_limit - np.abs(omega),
        bounds.yaw_rate_limit + np.abs(omega),
        bounds.lateral_limit - np.abs(v * omega),
        bounds.lateral_limit + np.abs(v * omega),
    )
    total += bounds.limit_penalty * sum(hinge(0.05 - margin, 0.05).sum() for margin in limits)
    return total + bounds.reverse_braking_penalty * (controls[:, 1] @ hinge(-v, 0.05))


@given(seeds)
def test_the_cost_is_the_one_of_the_case(problem, parameters_toward, seed):
    generator = np.random.default_rng(seed)
    # Slow turns: the unwrapped reference equals the wrapped error while the prediction stays within half a turn of it.
    state = generator.uniform(-1, 1, 6) * (1, 1, 1, 1, 1, 0.2)
    state[2] += 2 * np.pi * generator.integers(-3, 4)
    parameters = parameters_toward((2.0, 0.5, 0.3), obstacles=(BOX,))
    controls = random_controls(seed) * (0.3, 0.3, 0.1)
    expected = cost_by_the_book(problem, controls, state, parameters)
    # Not closer: inside a core rectangle the distance is 1e-9 m off, which counts with the penalty's slope.
    assert evaluate(problem, controls, state, parameters)[0] == pytest.approx(expected, rel=1e-7)


@given(seeds)
def test_the_gradient_is_that_of_finite_differences(problem, parameters_toward, seed):
    generator = np.random.default_rng(seed)
    state, controls = generator.uniform(-1, 1, 6), random_controls(seed) / 2
    parameters = parameters_toward((2.0, 0.5, 1.0), obstacles=(BOX,))
    direction = generator.normal(size=(20, 3))
    ahead, behind = (evaluate(problem, controls + s * 1e-6 * direction, state, parameters)[0] for s in (1, -1))
    gradient = evaluate(problem, controls, state, parameters)[1]
    scale = np.abs(gradient).max()
    assert np.sum(gradient * direction) == pytest.approx((ahead - behind) / 2e-6, rel=1e-5, abs=1e-4 * scale)


def test_the_hessian_is_the_derivative_of_the_gradient(problem, parameters_toward):
    state, controls = np.array([0, 0, 0.2, 0.5, 0, 0.1]), random_controls(3) / 4
    parameters = parameters_toward((2.0, 0.5, 1.0), obstacles=(BOX,))
    direction = np.random.default_rng(4).normal(size=(20, 3))
    ahead, behind = (evaluate(problem, controls + s * 1e-6 * direction, state, parameters)[1] for s in (1, -1))
    hessian = problem.hessian(controls.T, state, problem.pack(state, parameters)).full()
    numeric = (ahead - behind).ravel() / 2e-6
    np.testing.assert_allclose(hessian @ direction.ravel(), numeric, atol=1e-4 * np.abs(numeric).max())


def test_stage_jacobians_are_those_of_finite_differences(problem, parameters_toward):
    parameters = parameters_toward((1.0,))
    controls = random_controls(5)
    states = problem.rollout(np.array([0, 0, 0.3, 0.5, 0.1, 0.2]), controls, parameters)
    p = parameters.dynamics.vector
    by_state, by_control = (j.full() for j in problem.stage_jacobians(states[:-1].T, controls.T, p))
    for k in (0, 7, 19):
        for matrix, size, vary in ((by_state, 6, 0), (by_control, 3, 1)):
            for i in range(size):
                ends = []
                for sign in (1, -1):
                    point = [states[k].copy(), controls[k].copy()]
                    point[vary][i] += sign * 1e-6
                    ends.append(problem.step(*point, p).full()[:, 0])
                np.testing.assert_allclose(matrix[:, size * k + i], (ends[0] - ends[1]) / 2e-6, atol=1e-8)


def test_the_trajectory_function_agrees_with_the_rollout_and_the_geometry(problem, parameters_toward):
    parameters = parameters_toward((2.0,), obstacles=(BOX,))
    state, controls = np.array([0, 0, 0.3, 0.5, 0, 0]), random_controls(6) / 3
    outputs = problem.trajectory(controls.T, state, problem.pack(state, parameters))
    states, margins, limits, obstacle_duals, limit_duals = (output.full().T for output in outputs)
    np.testing.assert_allclose(states, problem.rollout(state, controls, parameters), atol=1e-12)
    np.testing.assert_allclose(margins[:, 0], ShapeDistances([BOX])(states[1:, :2])[:, 0] - 0.38, atol=1e-9)
    np.testing.assert_allclose(limits[:, LIMITS.index("speed")], 1.5 - states[1:, 3])
    assert margins.shape == obstacle_duals.shape == (20, 8)
    assert limits.shape == limit_duals.shape == (20, len(LIMITS))
    assert (obstacle_duals[margins > 0.04] == 0).all()


def test_buffers_give_what_the_function_gives(problem, parameters_toward):
    parameters, state = parameters_toward((2.0,), obstacles=(BOX,)), np.array([0, 0, 0.3, 0.5, 0, 0])
    controls = random_controls(7)
    buffered = BufferedFunction(problem.cost_and_gradient)
    packed = problem.pack(state, parameters)
    for argument, value in zip(buffered.arguments, (controls.T, state[:, None], packed[:, None]), strict=True):
        argument[:] = value
    buffered()
    cost, gradient = evaluate(problem, controls, state, parameters)
    assert buffered.results[0][0, 0] == cost
    np.testing.assert_array_equal(buffered.results[1].T, gradient)


def test_parameters_of_another_horizon_are_refused(parameters_toward):
    with pytest.raises(BadInput, match="horizon"):
        mut.OptimalControlProblem(horizon=10).pack(np.zeros(6), parameters_toward((1.0,)))


@pytest.mark.parametrize("sizes", [{"horizon": 0}, {"period": 0.0}, {"obstacle_slots": -1}])
def test_a_problem_without_size_is_refused(sizes):
    with pytest.raises(BadInput, match="positive"):
        mut.OptimalControlProblem(**sizes)


def test_another_horizon_is_the_same_problem_otherwise():
    problem = mut.OptimalControlProblem(horizon=6, period=0.1, obstacle_slots=3)
    assert problem.of_horizon(6) is problem
    shorter = problem.of_horizon(4)
    assert (shorter.horizon, shorter.period, shorter.layout.slots) == (4, 0.1, 3)
    assert problem.of_horizon(4) is shorter
    with pytest.raises(BadInput, match="horizon"):
        problem.of_horizon(0)
