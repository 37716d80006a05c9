"""The real-time iteration: convergence against SNOPT, phases, hard clearance, and every way to fail."""

import dataclasses

import numpy as np
import pytest

import mala_drake.control.rti as mut
from mala_drake.control import MakeSolver, Status
from mala_drake.control.qp import QpStatus
from mala_drake.control.qp.soft_box_qp import failed
from mala_drake.errors import BadInput
from mala_drake.messages import Shape
from mala_drake.ward.shapes import ShapeDistances

from .cases import BOX, START, random_case


@pytest.mark.parametrize("seed", range(6))
def test_from_snopts_optimum_it_stays_there(problem, rti, snopt, parameters_toward, seed):
    state, parameters = random_case(seed, parameters_toward, obstacles=(BOX,))
    theirs = snopt.solve(state, parameters)
    ours = rti.solve(state, parameters, theirs.controls)
    assert ours.status is Status.SOLVED
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_from_cold_it_finds_snopts_optimum_where_nothing_is_in_the_way(problem, rti, snopt, parameters_toward, seed):
    state, parameters = random_case(seed, parameters_toward)
    ours, theirs = rti.solve(state, parameters), snopt.solve(state, parameters)
    assert ours.status is Status.SOLVED
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-3)


def test_the_line_search_brings_it_down_beside_an_obstacle(problem, parameters_toward):
    patient = MakeSolver("rti", problem, sqp_iterations=100)
    for seed in range(12):
        state, parameters = random_case(seed, parameters_toward, obstacles=(BOX, Shape("post", 2.4, -0.3, radius=0.2)))
        solution = patient.solve(state, parameters)
        assert solution.status is Status.SOLVED
        assert solution.iterations < 60


def test_more_iterations_never_cost_more(problem, parameters_toward):
    state, parameters = random_case(3, parameters_toward, obstacles=(BOX,))
    costs = [MakeSolver("rti", problem, sqp_iterations=n).solve(state, parameters).cost for n in (1, 2, 3, 5, 20)]
    assert costs == sorted(costs, reverse=True)
    assert costs[0] > costs[-1]


def test_one_iteration_that_is_not_enough_is_told(problem, parameters_toward):
    state, parameters = random_case(3, parameters_toward, obstacles=(BOX,))
    solution = MakeSolver("rti", problem, sqp_iterations=1).solve(state, parameters)
    assert solution.status is Status.ITERATION_LIMIT
    assert not solution.success
    assert (solution.controls >= parameters.inputs.lower).all()
    assert (solution.controls <= parameters.inputs.upper).all()


def test_a_solution_with_its_multipliers_is_stationary(problem, rti, parameters_toward):
    parameters = parameters_toward((3.0, 0.3), obstacles=(BOX,), speed_limit=0.8)
    solution = rti.solve(START, parameters)
    slope = problem.cost_and_gradient(solution.controls.T, START, problem.pack(START, parameters))[1].full().T
    np.testing.assert_allclose(slope, solution.control_duals, atol=5.0)
    assert np.abs(solution.control_duals).max() > 50.0
    assert solution.obstacle_duals.max() > 0.0
    assert solution.limit_duals[:, 0].max() > 0.0


def test_the_phases_together_are_the_solve(rti, parameters_toward):
    parameters = parameters_toward((3.0, 0.3), obstacles=(BOX,))
    whole = rti.solve(START, parameters)
    rti.prepare(START, parameters)
    assert rti.feedback(START, parameters).controls.tobytes() == whole.controls.tobytes()


def test_feedback_answers_to_the_measured_state_and_to_new_limits(problem, parameters_toward):
    once = MakeSolver("rti", problem, sqp_iterations=1)
    parameters = parameters_toward((3.0, 0.3), obstacles=(BOX,))
    before = MakeSolver("rti", problem).solve(START, parameters)
    measured = before.states[1] + np.array([0.01, -0.01, 0.02, 0.03, 0.0, -0.03])
    slower = parameters_toward((3.0, 0.4), obstacles=(BOX, Shape("post", 2.0, -0.5, radius=0.1)), speed_limit=1.2)
    once.prepare(before.states[1], parameters, before.shifted())
    found = once.feedback(measured, slower)
    best = MakeSolver("rti", problem, sqp_iterations=50).solve(measured, slower, before.shifted())
    unaware = problem.cost(before.shifted().T, measured, problem.pack(measured, slower))
    np.testing.assert_array_equal(found.states[0], measured)
    # One iteration closes most of the gap between the shifted controls and the optimum.
    assert found.cost - best.cost < 0.1 * (float(unaware) - best.cost)


def test_without_a_preparation_that_fits_feedback_does_it_all(problem, parameters_toward):
    parameters = parameters_toward((3.0, 0.3))
    heavier = dataclasses.replace(
        parameters, stage=dataclasses.replace(parameters.stage, control_weights=np.full(3, 30.0))
    )
    solver = MakeSolver("rti", problem)
    expected = MakeSolver("rti", problem).solve(START, heavier)
    assert solver.feedback(START, heavier).cost == pytest.approx(expected.cost, rel=1e-6)
    solver.prepare(START, parameters)
    assert solver.feedback(START, heavier).cost == pytest.approx(expected.cost, rel=1e-3)


@pytest.mark.parametrize("qp_solver", ["clarabel", "osqp"])
def test_drakes_qp_solvers_lead_to_the_same_optimum(problem, rti, parameters_toward, qp_solver):
    state, parameters = random_case(1, parameters_toward, obstacles=(BOX,))
    other = MakeSolver("rti", problem, qp_solver=qp_solver).solve(state, parameters)
    assert other.status is Status.SOLVED
    assert other.cost == pytest.approx(rti.solve(state, parameters).cost, rel=1e-3)


def test_hard_clearance_holds_against_a_pull_that_outweighs_the_penalty(problem, rti, parameters_toward):
    wall = Shape("wall", 1.2, 0.0, 0.0, half_length=0.05, half_width=2.0)
    parameters = parameters_toward((2.0, 0.0, 0.0), obstacles=(wall,), obstacle_penalty=200.0)
    hard = MakeSolver("rti", problem, hard_clearance=True, sqp_iterations=50)
    soft, kept = rti.solve(START * 0, parameters), hard.solve(START * 0, parameters)
    assert soft.obstacle_margins.min() < -0.05
    assert kept.status is Status.SOLVED
    assert kept.obstacle_margins.min() > -1e-3
    theirs = MakeSolver("snopt", problem, hard_clearance=True).solve(START * 0, parameters)
    assert kept.cost == pytest.approx(theirs.cost, rel=1e-4)
    assert kept.obstacle_duals.sum() == pytest.approx(theirs.obstacle_duals.sum(), rel=1e-3)


def test_a_loop_beside_a_box_keeps_its_clearance_and_arrives(problem, rti, parameters_toward):
    parameters = parameters_toward((3.0, 0.2, 0.0), obstacles=(BOX,))
    state, warm_start, states = START, None, []
    for _ in range(45):
        solution = rti.solve(state, parameters, warm_start)
        assert solution.success
        warm_start = solution.shifted()
        state = problem.step(state, solution.controls[0], parameters.dynamics.vector).full()[:, 0]
        states.append(state)
    assert np.hypot(*(state[:2] - (3.0, 0.2))) < 0.15
    assert ShapeDistances([BOX])(np.array(states)[:, :2]).min() - 0.28 > 0.09


class FailingQp:
    """A QP solver that fails from its n-th call on."""

    name = "failing"

    def __init__(self, solver, good):
        self._solver, self._good = solver, good

    def solve(self, problem, guess=None):
        self._good -= 1
        return self._solver.solve(problem, guess) if self._good >= 0 else failed(problem, QpStatus.FAILED)


@pytest.mark.parametrize("good", [0, 1])
def test_a_qp_without_solution_ends_the_solve_with_admissible_controls(problem, parameters_toward, good, monkeypatch):
    state, parameters = random_case(3, parameters_toward, obstacles=(BOX,))
    solver = MakeSolver("rti", problem)
    monkeypatch.setattr(solver._tools, "qp_solver", FailingQp(solver._tools.qp_solver, good))
    solution = solver.solve(state, parameters)
    assert solution.status is Status.NUMERICAL
    assert (solution.controls >= parameters.inputs.lower).all()
    assert (solution.controls <= parameters.inputs.upper).all()
    monkeypatch.undo()
    assert solver.solve(state, parameters).success


def test_a_qp_that_is_never_given_all_its_rows_still_gives_a_step(problem, parameters_toward, monkeypatch):
    monkeypatch.setattr("mala_drake.control.step_model._PASSES", 1)
    state, parameters = random_case(0, parameters_toward, obstacles=(BOX,), speed_limit=0.4)
    solution = MakeSolver("rti", problem).solve(state, parameters)
    assert solution.status is not Status.NUMERICAL
    assert solution.optimality < 10.0


def test_walls_that_have_no_solution_fall_back_to_the_penalty(problem, parameters_toward, monkeypatch):
    solver = MakeSolver("rti", problem, hard_clearance=True)
    inner = solver._tools.qp_solver

    class NoWalls:
        def solve(self, problem, guess=None):
            hard = np.isinf(problem.prices).any()
            return failed(problem, QpStatus.INFEASIBLE) if hard else inner.solve(problem, guess)

    monkeypatch.setattr(solver._tools, "qp_solver", NoWalls())
    state, parameters = random_case(3, parameters_toward, obstacles=(BOX,))
    assert solver.solve(state, parameters).status is Status.SOLVED


def test_a_preparation_for_a_state_that_is_not_finite_is_no_preparation(rti, parameters_toward):
    parameters = parameters_toward((1.0,))
    rti.prepare(START * np.nan, parameters)
    assert rti.feedback(START, parameters).success
    rti.prepare(START, parameters)
    assert rti.feedback(START * np.nan, parameters).status is Status.INVALID_INPUT


def test_a_number_of_iterations_that_is_not_positive_is_refused(problem):
    with pytest.raises(BadInput, match="sqp_iterations"):
        mut.RealTimeIterationSolver(problem, sqp_iterations=0)
