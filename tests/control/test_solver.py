"""What holds of every solver: its name, optimality, warm starts, and answers to what cannot be solved."""

import subprocess
import sys

import numpy as np
import pytest

import mala_drake.control.solver as mut
from mala_drake.control import Status
from mala_drake.errors import BadInput

from .cases import BOX, START


@pytest.fixture(scope="module", params=["snopt", "ipopt", "rti"])
def solver(request, problem):
    return mut.MakeSolver(request.param, problem)


@pytest.mark.parametrize("name", ["snopt", "ipopt", "rti"])
def test_a_solver_is_made_by_its_name(problem, name):
    assert mut.MakeSolver(name, problem).name == name


def test_an_unknown_name_is_told_with_the_known_ones(problem):
    with pytest.raises(BadInput, match=r"'fmincon'.*snopt, ipopt, rti"):
        mut.MakeSolver("fmincon", problem)


def test_the_names_are_known_without_loading_any_solver():
    code = "import sys, mala_drake.control as c; print(c.SOLVER_NAMES, 'pydrake.solvers' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.startswith("('snopt', 'ipopt'")
    assert out.strip().endswith("False")


def test_the_kkt_conditions_hold_at_the_solution(problem, solver, parameters_toward):
    parameters = parameters_toward((3.0, 0.3), obstacles=(BOX,))
    solution = solver.solve(START, parameters)
    assert solution.status is Status.SOLVED
    assert solution.optimality < 1e-3
    # Stationarity: the gradient is the multiplier of the box, up to the tolerance in units of the terminal weight.
    packed = problem.pack(START, parameters)
    slope = problem.cost_and_gradient(solution.controls.T, START, packed)[1].full().T
    np.testing.assert_allclose(slope, solution.control_duals, atol=5.0)
    lower, upper = parameters.inputs.lower, parameters.inputs.upper
    assert (solution.controls >= lower).all()
    assert (solution.controls <= upper).all()
    inside = (solution.controls > lower + 0.02) & (solution.controls < upper - 0.02)
    assert np.abs(solution.control_duals[inside]).max() < 5.0
    assert (solution.control_duals[solution.controls < lower + 1e-6] > -5.0).all()
    assert (solution.control_duals[solution.controls > upper - 1e-6] < 5.0).all()


@pytest.mark.parametrize(("name", "saving"), [("snopt", 2.0), ("rti", 1.5)])
def test_a_shifted_warm_start_saves_evaluations_at_equal_cost(problem, parameters_toward, name, saving):
    solver = mut.MakeSolver(name, problem)
    parameters = parameters_toward((3.0, 0.3))  # Nothing in the way: with obstacles the optimum need not be the same.
    state, warm_start, cold_evaluations, warm_evaluations = START, None, 0, 0
    for _ in range(8):
        warm = solver.solve(state, parameters, warm_start)
        if warm_start is not None:
            cold = solver.solve(state, parameters)
            assert warm.cost == pytest.approx(cold.cost, rel=1e-3)
            cold_evaluations, warm_evaluations = cold_evaluations + cold.iterations, warm_evaluations + warm.iterations
        warm_start = warm.shifted()
        state = problem.step(state, warm.controls[0], parameters.dynamics.vector).full()[:, 0]
    assert saving * warm_evaluations < cold_evaluations


def test_the_same_solve_gives_the_same_bytes(problem, solver, parameters_toward):
    parameters = parameters_toward((3.0, 0.3), obstacles=(BOX,))
    first = solver.solve(START, parameters)
    solver.solve(START + 0.3, parameters)
    assert solver.solve(START, parameters).controls.tobytes() == first.controls.tobytes()


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_a_state_that_is_not_finite_is_answered_not_raised(solver, parameters_toward, broken):
    state = START.copy()
    state[1] = broken
    solution = solver.solve(state, parameters_toward((1.0,)))
    assert solution.status is Status.INVALID_INPUT
    assert not solution.success
    # The program is unharmed.
    assert solver.solve(START, parameters_toward((1.0,))).success


@pytest.mark.parametrize("size", [1e80, 1e170, 1e300])
def test_a_finite_state_that_overflows_the_model_is_answered_not_raised(solver, parameters_toward, size):
    solution = solver.solve(START + np.array([size, 0, 0, size, 0, 0]), parameters_toward((1.0,), obstacles=(BOX,)))
    assert not solution.success
    assert np.isfinite(solution.controls).all()
    assert solver.solve(START, parameters_toward((1.0,))).success
