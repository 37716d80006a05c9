import numpy as np

import mala_drake.control.gauss_newton as mut
from mala_drake.control import MakeSolver
from mala_drake.messages import Shape

BOX = Shape("box", 1.2, 0.3, 0.4, 0.3, 0.2, 0.05)


def trajectory(problem, parameters, seed=0):
    generator = np.random.default_rng(seed)
    state = np.array([0.0, 0.0, 0.3, 0.6, 0.0, 0.1])
    controls = generator.uniform((-0.5, 0, -0.3), (0.5, 0.4, 0.3), (20, 3))
    return state, controls, problem.rollout(state, controls, parameters)


def hessian(problem, parameters, seed=0):
    state, controls, states = trajectory(problem, parameters, seed)
    packed = problem.pack(state, parameters)
    return mut.GaussNewtonModel(problem).hessian(states, controls, packed, parameters.stage.control_weights)


def test_without_active_penalties_it_is_the_square_of_the_finite_difference_sensitivities(problem, parameters_toward):
    parameters = parameters_toward((1.0, 0.2), speed_limit=9.0, limit_penalty=0.0)
    state, controls, _ = trajectory(problem, parameters)
    columns = []
    for i in range(60):
        offset = np.zeros(60)
        offset[i] = 1e-6
        ends = [problem.rollout(state, controls + s * offset.reshape(20, 3), parameters)[1:] for s in (1, -1)]
        columns.append(((ends[0] - ends[1]) / 2e-6).ravel())
    sensitivities = np.array(columns).T
    weights = np.tile(parameters.stage.state_weights, 20)
    weights[-6:] = parameters.terminal.weights
    expected = 2 * sensitivities.T @ (weights[:, None] * sensitivities)
    expected += 2 * np.diag(np.tile(parameters.stage.control_weights, 20))
    np.testing.assert_allclose(hessian(problem, parameters), expected, atol=1e-5 * np.abs(expected).max())


def test_it_stays_positive_definite_inside_an_obstacle(problem, parameters_toward):
    inside = parameters_toward((1.0, 0.2), obstacles=(BOX, Shape("disc", 0.0, 0.0, radius=0.5)))
    for seed in range(5):
        assert np.linalg.eigvalsh(hessian(problem, inside, seed)).min() > 1.0


def test_near_a_solution_it_whitens_the_exact_hessian(problem, parameters_toward):
    parameters = parameters_toward((3.0, 0.2))
    state = np.array([0.0, 0.0, 0.1, 0.8, 0.0, 0.0])
    solution = MakeSolver("snopt", problem).solve(state, parameters)
    packed = problem.pack(state, parameters)
    exact = problem.hessian(solution.controls.T, state, packed).full()
    model = mut.GaussNewtonModel(problem)
    approximate = model.hessian(solution.states, solution.controls, packed, parameters.stage.control_weights)
    factor = np.linalg.inv(np.linalg.cholesky(approximate))
    assert np.linalg.cond(factor @ exact @ factor.T) < np.linalg.cond(exact) / 100
