import numpy as np

import mala_drake.control.initial_guess as mut
from mala_drake.control import ConstraintParameters, MpcParameters, StageParameters, TerminalParameters


def cruise(speed):
    states = np.zeros((21, 6))
    states[:, 3] = speed
    states[:, 0] = 0.2 * speed * np.arange(21)
    return MpcParameters(
        TerminalParameters(states[-1]), StageParameters(states[:-1]), ConstraintParameters(np.full(20, 1.5))
    )


def velocities(problem, state, controls, parameters):
    return problem.rollout(state, controls, parameters)[:, 3]


def test_one_guess_takes_up_the_speed_of_the_reference_and_another_stops(problem):
    state, parameters = np.array([0, 0, 0, 0.4, 0, 0.3]), cruise(1.0)
    follow, stop = mut.InitialGuesses(problem)(state, parameters, None)
    assert abs(velocities(problem, state, follow, parameters)[3:] - 1.0).max() < 1e-9
    assert abs(velocities(problem, state, stop, parameters)[3:]).max() < 1e-9


def test_guesses_are_admissible(problem):
    parameters = cruise(1.5)
    wild = np.full((20, 3), 50.0)
    guesses = mut.InitialGuesses(problem)(np.array([0, 0, 0, -0.5, 0, 3.0]), parameters, wild)
    assert len(guesses) == 3
    for guess in guesses:
        assert (guess >= parameters.inputs.lower).all()
        assert (guess <= parameters.inputs.upper).all()


def test_a_warm_start_that_is_not_finite_is_left_out(problem):
    assert len(mut.InitialGuesses(problem)(np.zeros(6), cruise(1.0), np.full((20, 3), np.nan))) == 2
