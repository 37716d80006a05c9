"""The linearisation against finite differences of the model, the margins and the cost."""

import numpy as np

import mala_drake.control.linearisation as mut
from mala_drake.control.condensing import state_sensitivities
from mala_drake.control.penalty import huberised_hinge
from mala_drake.messages import Shape

SHAPES = (Shape("box", 1.2, 0.3, 0.4, 0.3, 0.2, 0.05), Shape("disc", 0.3, -0.6, radius=0.3))


def case(problem, parameters_toward, seed=0, **constraints):
    generator = np.random.default_rng(seed)
    parameters = parameters_toward((1.5, 0.4), obstacles=SHAPES, speed_limit=0.7, **constraints)
    state = np.array([0.0, 0.0, 0.3, 0.5, 0.05, 0.1])
    controls = generator.uniform((-0.8, 0, -0.8), (0.5, 0.4, 0.8), (20, 3))
    return parameters, state, controls, problem.pack(state, parameters)


def linearise(problem, parameters, state, controls, packed):
    return mut.Lineariser(problem)(state, controls, packed)


def penalties(linearisation):
    return sum(
        float(price * huberised_hinge(excess, width))
        for prices, excesses in zip(linearisation.prices, linearisation.excesses, strict=True)
        for price, excess, width in zip(prices, excesses, linearisation.widths, strict=True)
    )


def test_it_follows_the_rollout(problem, parameters_toward):
    parameters, state, controls, packed = case(problem, parameters_toward)
    found = linearise(problem, parameters, state, controls, packed)
    np.testing.assert_allclose(found.states, problem.rollout(state, controls, parameters), atol=1e-12)


def test_the_stage_jacobians_are_those_of_the_model(problem, parameters_toward):
    parameters, state, controls, packed = case(problem, parameters_toward)
    found = linearise(problem, parameters, state, controls, packed)
    states, dynamics = problem.rollout(state, controls, parameters), parameters.dynamics.vector
    for k in (0, 4, 19):
        for i in range(9):
            offset = 1e-6 * np.eye(9)[i]
            ahead, behind = (
                problem.step(states[k] + s * offset[:6], controls[k] + s * offset[6:], dynamics).full()[:, 0]
                for s in (1, -1)
            )
            jacobian = np.hstack((found.transitions[k], found.inputs[k]))
            np.testing.assert_allclose(jacobian[:, i], (ahead - behind) / 2e-6, atol=1e-8)


def test_the_slopes_of_the_rows_are_those_of_their_excesses(problem, parameters_toward):
    _, state, controls, packed = case(problem, parameters_toward)
    lineariser = mut.Lineariser(problem)
    found = lineariser(state, controls, packed)
    rows = mut._rows(problem, 7)
    parts = (found.states[8], controls[7], packed)
    near = found.excesses[7] > -50.0  # Empty slots hold a point ten kilometres away, where differences drown.
    np.testing.assert_allclose(rows(*parts)[0].full()[:, 0], found.excesses[7], atol=1e-12)
    for i in range(6):
        ahead, behind = (rows(parts[0] + s * 1e-6 * np.eye(6)[i], *parts[1:])[0].full()[:, 0] for s in (1, -1))
        np.testing.assert_allclose(found.slopes[7, near, i], ((ahead - behind) / 2e-6)[near], atol=1e-6)


def test_cost_is_tracking_and_the_penalties_of_the_rows(problem, parameters_toward):
    parameters, state, controls, packed = case(problem, parameters_toward, seed=3)
    found = linearise(problem, parameters, state, controls, packed)
    tracking = case(problem, parameters_toward, seed=3, obstacle_penalty=0, limit_penalty=0, reverse_braking_penalty=0)
    without = problem.cost(controls.T, state, tracking[3])
    assert penalties(found) > 1.0
    np.testing.assert_allclose(float(problem.cost(controls.T, state, packed) - without), penalties(found), rtol=1e-9)


def test_condensed_gradients_add_up_to_the_gradient_of_the_cost(problem, parameters_toward):
    for seed in range(4):
        parameters, state, controls, packed = case(problem, parameters_toward, seed)
        found = linearise(problem, parameters, state, controls, packed)
        sensitivities = state_sensitivities(found.transitions, found.inputs)
        # The penalty's slope is its price times the excess over the width, and one price past the width.
        force = found.prices * np.clip(found.excesses / found.widths, 0.0, 1.0)
        pull = found.state_gradients + np.einsum("kr,kri->ki", force, found.slopes)
        gradient = np.einsum("ki,kij->j", pull, sensitivities) + found.control_gradients.ravel()
        exact = problem.cost_and_gradient(controls.T, state, packed)[1].full().T.ravel()
        np.testing.assert_allclose(gradient, exact, rtol=1e-7, atol=1e-7 * np.abs(exact).max())


def test_the_weights_are_the_second_derivatives_of_tracking(problem, parameters_toward):
    parameters, state, controls, packed = case(problem, parameters_toward)
    found = linearise(problem, parameters, state, controls, packed)
    np.testing.assert_allclose(found.state_weights[3], 2 * parameters.stage.state_weights)
    np.testing.assert_allclose(found.state_weights[-1], 2 * parameters.terminal.weights)
    np.testing.assert_allclose(found.control_weights[7], 2 * parameters.stage.control_weights)
