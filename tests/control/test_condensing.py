"""Condensing against the dense formulation with all states as variables, and against finite differences."""

import numpy as np

import mala_drake.control.condensing as mut


def random_system(seed, *, horizon=7, states=4, controls=2):
    generator = np.random.default_rng(seed)
    transitions = 0.6 * generator.standard_normal((horizon, states, states))
    return transitions, generator.standard_normal((horizon, states, controls)), generator


def dense_dynamics(transitions, inputs):
    """(G, F) of G dX + F dU = 0, the dynamics from dz_0 = 0 as one linear system."""
    horizon, n, m = inputs.shape
    states, controls = np.eye(n * horizon), np.zeros((n * horizon, m * horizon))
    for k in range(horizon):
        controls[n * k : n * (k + 1), m * k : m * (k + 1)] = -inputs[k]
        if k:
            states[n * k : n * (k + 1), n * (k - 1) : n * k] = -transitions[k]
    return states, controls


def test_sensitivities_solve_the_dense_dynamics():
    transitions, inputs, _ = random_system(0)
    states, controls = dense_dynamics(transitions, inputs)
    found = mut.state_sensitivities(transitions, inputs).reshape(28, 14)
    np.testing.assert_allclose(found, np.linalg.solve(states, -controls), atol=1e-12)


def test_the_condensed_minimum_is_that_of_the_dense_problem_with_its_multipliers():
    transitions, inputs, generator = random_system(1)
    weights, efforts = generator.uniform(0.1, 2.0, (7, 4)), generator.uniform(0.1, 2.0, 14)
    pull, push = generator.standard_normal((7, 4)), generator.standard_normal(14)
    states, controls = dense_dynamics(transitions, inputs)
    kkt = np.zeros((70, 70))
    kkt[:28, :28], kkt[28:42, 28:42] = np.diag(weights.ravel()), np.diag(efforts)
    kkt[42:, :28], kkt[42:, 28:42] = states, controls
    kkt[:42, 42:] = kkt[42:, :42].T
    dense = np.linalg.solve(kkt, -np.concatenate((pull.ravel(), push, np.zeros(28))))

    sensitivities = mut.state_sensitivities(transitions, inputs)
    hessian = mut.condensed_hessian(sensitivities, weights, efforts)
    gradient = pull.ravel() @ sensitivities.reshape(28, 14) + push
    step = np.linalg.solve(hessian, -gradient)
    np.testing.assert_allclose(step, dense[28:42], atol=1e-9)
    slopes = weights * (sensitivities @ step) + pull
    np.testing.assert_allclose(mut.costates(transitions, slopes).ravel(), -dense[42:], atol=1e-9)


def test_costates_are_the_derivatives_of_the_cost_by_a_displaced_state(problem, parameters_toward):
    parameters = parameters_toward((1.0, 0.5, 0.2))
    state, controls = np.array([0, 0, 0.3, 0.6, 0, 0.2]), np.full((20, 3), (0.1, 0.0, 0.05))
    dynamics = parameters.dynamics.vector
    goals = np.vstack((parameters.stage.references[1:], parameters.terminal.target))
    weights = np.tile(parameters.stage.state_weights, (20, 1))
    weights[-1] = parameters.terminal.weights

    def cost(stage, displacement):
        z, total = state, 0.0
        for k in range(20):
            z = problem.step(z, controls[k], dynamics).full()[:, 0]
            z = z + displacement * (k + 1 == stage)
            total += weights[k] @ (z - goals[k]) ** 2
        return total

    states = problem.rollout(state, controls, parameters)
    blocks = problem.stage_jacobians(states[:-1].T, controls.T, dynamics)[0].full()
    transitions = np.stack(np.split(blocks, 20, axis=1))
    found = mut.costates(transitions, 2 * weights * (states[1:] - goals))
    for stage in (1, 7, 20):
        for i in range(6):
            offset = 1e-6 * np.eye(6)[i]
            slope = (cost(stage, offset) - cost(stage, -offset)) / 2e-6
            np.testing.assert_allclose(found[stage - 1, i], slope, rtol=1e-5, atol=1e-4)


def test_whitening_makes_the_hessian_the_identity_and_survives_what_overflows():
    root = np.random.default_rng(0).standard_normal((9, 9))
    transform = mut.whitening(root @ root.T)
    np.testing.assert_allclose(transform.T @ (root @ root.T) @ transform, np.eye(9), atol=1e-9)
    with np.errstate(all="ignore"):
        np.testing.assert_array_equal(mut.whitening(-np.eye(3)), np.eye(3))
        for broken in (np.full((3, 3), np.inf), np.full((3, 3), np.nan)):
            assert np.isfinite(mut.whitening(broken)).all()
