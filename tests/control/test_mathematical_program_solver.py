"""SNOPT and IPOPT: multipliers, parameter groups, closed loops and faults."""

import dataclasses

import numpy as np
import pytest

from mala_drake.control import DynamicsParameters, InputParameters, MakeSolver, Status
from mala_drake.ward.shapes import ShapeDistances

from .cases import BOX, START, random_case


def drive(problem, solver, state, parameters, *, steps, noise=0.0, seed=0):
    generator, warm_start, states = np.random.default_rng(seed), None, [np.array(state, float)]
    for _ in range(steps):
        solution = solver.solve(states[-1], parameters, warm_start)
        assert solution.success
        warm_start = solution.shifted()
        ahead = problem.step(states[-1], solution.controls[0], parameters.dynamics.vector).full()[:, 0]
        states.append(ahead + noise * generator.standard_normal(6) * (1, 1, 1, 1, 0, 1))
    return np.array(states)


def test_the_dual_of_a_bound_is_the_derivative_of_the_optimal_cost(problem, parameters_toward):
    precise = MakeSolver("snopt", problem, tolerance=1e-9)
    parameters = parameters_toward((4.0, 0.0))

    def solve(limit):
        inputs = InputParameters(upper=np.array([limit, 2.0, 1.0]))
        return precise.solve(START, dataclasses.replace(parameters, inputs=inputs))

    above, below = solve(0.8 + 1e-4).cost, solve(0.8 - 1e-4).cost
    duals = solve(0.8).control_duals[:, 0]
    assert duals.min() < -100.0
    assert np.minimum(duals, 0.0).sum() == pytest.approx((above - below) / 2e-4, rel=1e-4)


def test_the_obstacle_multiplier_is_the_derivative_of_the_optimal_cost(problem, parameters_toward):
    precise = MakeSolver("snopt", problem, tolerance=1e-9)

    def solve(clearance):
        parameters = parameters_toward((3.0, 0.1), obstacles=(BOX,), clearance=clearance)
        return precise.solve(START, parameters, middle.controls if middle else None)

    middle = None
    middle = solve(0.1)
    slope = (solve(0.1 + 1e-5).cost - solve(0.1 - 1e-5).cost) / 2e-5
    assert slope > 10.0
    assert middle.obstacle_duals.sum() == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize("group", ["terminal", "stage", "dynamics", "constraints", "inputs"])
def test_each_of_the_five_groups_changes_the_solution(snopt, parameters_toward, group):
    one = parameters_toward((2.0, 0.3))
    other = {
        "terminal": dataclasses.replace(one.terminal, target=np.array([1.0, 0.5, 0.2, 0, 0, 0])),
        "stage": dataclasses.replace(one.stage, control_weights=np.array([30.0, 30.0, 23.0])),
        "dynamics": DynamicsParameters(yaw_coupling=0.5, propulsion_gain=0.8),
        "constraints": dataclasses.replace(one.constraints, speed_limits=np.full(20, 0.4)),
        "inputs": InputParameters(np.array([-0.3, 0.0, -0.2]), np.array([0.3, 0.3, 0.2])),
    }[group]
    first = snopt.solve(START, one)
    second = snopt.solve(START, dataclasses.replace(one, **{group: other}))
    assert first.success
    assert second.success
    assert np.abs(first.states - second.states).max() > 0.05
    # Nothing of the second action is left in the program.
    np.testing.assert_allclose(snopt.solve(START, one).controls, first.controls, atol=1e-6)


@pytest.mark.slow
def test_from_cold_both_solvers_agree_where_nothing_is_in_the_way(problem, snopt, parameters_toward):
    ipopt, generator = MakeSolver("ipopt", problem), np.random.default_rng(1)
    for _ in range(24):
        state, parameters = random_case(generator, parameters_toward)
        one, two = snopt.solve(state, parameters), ipopt.solve(state, parameters)
        assert one.success
        assert two.success
        assert two.cost == pytest.approx(one.cost, rel=1e-3)


@pytest.mark.slow
def test_beside_an_obstacle_both_solvers_agree_on_each_local_optimum(problem, snopt, parameters_toward):
    ipopt, generator = MakeSolver("ipopt", problem), np.random.default_rng(1)
    for _ in range(24):
        state, parameters = random_case(generator, parameters_toward, obstacles=(BOX,))
        one = snopt.solve(state, parameters)
        # Near this optimum; from cold the two may pass the box on different sides.
        two = ipopt.solve(state, parameters, one.controls + 0.01 * generator.standard_normal((20, 3)))
        assert one.success
        assert two.success
        assert two.cost == pytest.approx(one.cost, rel=1e-3)


def test_the_robot_stops_at_the_pose_from_wherever_it_comes(problem, snopt, parameters_toward):
    generator = np.random.default_rng(2)
    parameters = parameters_toward((0.0, 0.0, 0.0), speed_limit=1.5)
    for seed in range(6):
        distance, bearing = generator.uniform(1.0, 3.0), generator.uniform(-0.4, 0.4)
        state = [-distance * np.cos(bearing), -distance * np.sin(bearing), bearing, generator.uniform(0, 1), 0, 0]
        end = drive(problem, snopt, state, parameters, steps=50, noise=0.004, seed=seed)[-1]
        assert np.hypot(*end[:2]) < 0.15
        assert abs(end[2]) < 0.2
        assert abs(end[3]) < 0.05


def test_a_robot_that_overshot_creeps_back_in_reverse(problem, snopt, parameters_toward):
    states = drive(problem, snopt, [0.4, 0.0, 0.05, 0.3, 0, 0], parameters_toward((0.0, 0.0, 0.0)), steps=30)
    assert states[:, 3].min() < -0.1
    assert states[:, 3].min() > -0.5
    assert np.hypot(*states[-1, :2]) < 0.05


def test_the_brake_is_not_used_to_push_backward(problem, snopt, parameters_toward):
    solution = snopt.solve(np.array([1.5, 0, 0, 0.2, 0, 0]), parameters_toward((0.0, 0.0, 0.0)))
    backward = solution.states[1:, 3] < -0.02
    assert backward.sum() > 5
    assert solution.controls[backward & (solution.states[:-1, 3] < 0), 1].max() < 0.05


def test_a_box_in_the_way_is_passed_with_its_clearance(problem, snopt, parameters_toward):
    states = drive(problem, snopt, START, parameters_toward((3.0, 0.2, 0.0), obstacles=(BOX,)), steps=45)
    assert np.hypot(*(states[-1, :2] - (3.0, 0.2))) < 0.15
    assert ShapeDistances([BOX])(states[:, :2]).min() - 0.28 > 0.09


def test_the_path_limits_hold_along_the_closed_loop(problem, snopt, parameters_toward):
    states = drive(problem, snopt, START, parameters_toward((6.0, 2.0, 1.0), speed_limit=1.0), steps=20)
    assert states[:, 3].max() < 1.05
    assert np.abs(states[:, 3] * states[:, 5]).max() < 2.0


def test_a_callback_that_fails_is_reported_and_does_not_stick(problem, parameters_toward, monkeypatch, caplog):
    fresh = MakeSolver("snopt", problem)
    parameters = parameters_toward((1.0,))
    program, calls = fresh._program, []
    evaluate = program._function

    class Failing:
        arguments, results = evaluate.arguments, evaluate.results

        def __call__(self):
            calls.append(None)
            if len(calls) == 6:
                raise RuntimeError("broken on purpose")
            evaluate()

    monkeypatch.setattr(program, "_function", Failing())
    solution = fresh.solve(START, parameters)
    assert solution.status is Status.NUMERICAL
    assert np.isfinite(solution.controls).all()
    assert "broken on purpose" in caplog.text
    monkeypatch.undo()
    assert fresh.solve(START, parameters).success


@pytest.mark.parametrize("name", ["snopt", "ipopt"])
def test_an_iteration_limit_is_told(problem, parameters_toward, name):
    hasty = MakeSolver(name, problem, iteration_limit=2)
    solution = hasty.solve(START, parameters_toward((3.0, 0.5), obstacles=(BOX,)))
    assert solution.status is Status.ITERATION_LIMIT
    assert not solution.success
    assert solution.usable
