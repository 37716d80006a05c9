"""The controller alone when something is wrong: it brakes, and the report says what happened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mala_drake.control import mpc_controller as mut
from mala_drake.control.leg import LegRules
from mala_drake.control.solver import MakeSolver
from mala_drake.messages import Obstacles, Outcome, Shape

from .controller_bench import GO, ControllerBench


class FailingSolver:
    """Wraps a solver and lets its results fail from the given solve on, for the given number of solves."""

    name = "failing"

    def __init__(self, solver, first, count):
        self._solver, self._failing, self._calls = solver, range(first, first + count), 0

    def solve(self, initial_state, parameters, warm_start=None):
        self._calls += 1
        state = np.full(6, np.nan) if self._calls in self._failing else initial_state
        return self._solver.solve(state, parameters, warm_start)


def test_a_failed_solve_brakes_and_the_next_one_goes_on(problem):
    bench = ControllerBench(problem, solver=FailingSolver(MakeSolver("snopt", problem), 2, 1))
    bench.send(GO)
    bench.tick()
    bench.tick()
    assert tuple(bench.output("control")) == mut.PARKED
    report = bench.output("leg_report")
    assert (report.failures, report.not_converged) == (1, 0)
    assert bench.output("predicted_trajectory").states == ()
    bench.tick()
    assert bench.output("control")[0] > 0.1
    assert bench.output("leg_report").outcome is Outcome.RUNNING


def test_a_solver_that_keeps_failing_is_reported(problem):
    rules = LegRules(tolerated_failures=3)
    bench = ControllerBench(problem, solver=FailingSolver(MakeSolver("snopt", problem), 1, 1000), rules=rules)
    bench.send(GO)
    bench.tick(4)
    report = bench.output("leg_report")
    assert report.outcome is Outcome.SOLVER_FAILURE
    assert report.failures == 4
    assert "4 solves" in report.detail
    assert tuple(bench.output("control")) == mut.PARKED


def test_a_state_that_is_not_finite_brakes_and_is_reported_when_it_stays(bench):
    bench.send(GO)
    bench.tick()
    bench.place([np.nan] * 6)
    bench.tick()
    assert tuple(bench.output("control")) == mut.PARKED
    assert bench.output("predicted_trajectory").states == ()
    assert bench.output("leg_report").outcome is Outcome.RUNNING
    bench.tick(5)
    report = bench.output("leg_report")
    assert report.outcome is Outcome.INVALID_STATE
    assert (report.position_error, report.yaw_error, report.terminal_speed) == (None, None, None)


def test_a_place_that_nobody_knows_has_no_pose_to_be_off(bench):
    bench.place([0.0, 0.0, 0.0, 0.4, 0.0, 0.0])
    bench.send(replace(GO, place="nowhere"))
    bench.tick()
    report = bench.output("leg_report")
    assert report.outcome is Outcome.BLOCKED
    assert (report.position_error, report.yaw_error, report.terminal_speed) == (None, None, 0.4)


def test_one_lost_state_estimate_is_forgiven(bench):
    bench.send(GO)
    bench.tick()
    bench.place([0.0, np.inf, 0.0, 0.0, 0.0, 0.0])
    bench.tick()
    bench.place(np.zeros(6))
    bench.tick()
    assert bench.output("control")[0] > 0.1


def test_an_empty_battery_ends_the_leg(bench):
    bench.send(GO)
    bench.tick()
    bench.charge.GetMutableData().get_mutable_value().SetFromVector([0.0])
    bench.tick()
    assert bench.output("leg_report").outcome is Outcome.BATTERY_EMPTY
    assert tuple(bench.output("control")) == mut.PARKED


def test_a_blocked_way_is_reported_and_the_robot_stands(bench):
    bench.send(GO)
    bench.tick()
    bench.obstacles.GetMutableData().set_value(Obstacles((Shape("trolley", 6.0, 0.0, 0.0, 0.5, 0.5),)))
    bench.tick()
    report = bench.output("leg_report")
    assert report.outcome is Outcome.BLOCKED
    assert "trolley" in report.detail
