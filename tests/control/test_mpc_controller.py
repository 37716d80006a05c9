"""The controller alone, its inputs fixed: what it does when all is well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mala_drake.control import mpc_controller as mut
from mala_drake.control.solution import Status
from mala_drake.control.solver import MakeSolver
from mala_drake.messages import Action, ActionKind, MagnetCommand, Outcome

from .controller_bench import GO, ControllerBench


class HurriedSolver:
    """Wraps a solver and says of each result that it was stopped early."""

    name = "hurried"

    def __init__(self, solver):
        self._solver = solver

    def solve(self, initial_state, parameters, warm_start=None):
        return replace(self._solver.solve(initial_state, parameters, warm_start), status=Status.ITERATION_LIMIT)


def test_drawn_ports_are_the_real_ports(bench, assert_port_box):
    assert_port_box(bench.system)


def test_without_an_action_it_stays_parked(bench):
    bench.tick(3)
    assert tuple(bench.output("control")) == mut.PARKED
    assert bench.output("leg_report").sequence == 0


def test_a_movement_makes_it_drive_towards_the_place(bench):
    bench.send(GO)
    bench.tick()
    propulsion, brake, _ = bench.output("control")
    assert propulsion - brake > 0.1
    report = bench.output("leg_report")
    assert (report.sequence, report.outcome) == (1, Outcome.RUNNING)
    states = np.array(bench.output("predicted_trajectory").states)
    assert states.shape == (21, 6)
    assert states[-1, 0] > 1.0
    assert len(bench.system.solve_seconds) == 1


def test_an_in_place_action_parks_it(bench):
    bench.send(GO)
    bench.tick()
    bench.send(Action(2, ActionKind.IN_PLACE, "recharge", ("robot1",), "there"))
    bench.tick()
    assert tuple(bench.output("control")) == mut.PARKED
    assert bench.output("leg_report").sequence == 0


def test_at_rest_at_the_target_it_reports_success_with_its_errors(bench):
    bench.send(GO)
    bench.place([5.95, 0.03, 0.05, 0.0, 0.0, 0.0])
    bench.tick(2)
    report = bench.output("leg_report")
    assert report.outcome is Outcome.SUCCESS
    assert report.position_error == pytest.approx(np.hypot(0.05, 0.03))
    assert report.yaw_error == pytest.approx(0.05)
    assert tuple(bench.output("control")) == mut.PARKED


def test_the_closed_loop_cost_ends_with_the_terminal_cost_of_the_reached_state(bench):
    bench.send(GO)
    bench.tick()
    bench.place([5.95, 0.03, 0.05, 0.01, 0.0, 0.0])
    before = bench.output("leg_report").closed_loop_cost
    bench.tick(2)
    report = bench.output("leg_report")
    assert report.outcome is Outcome.SUCCESS
    errors = np.array([0.05, 0.03, 0.05, 0.01, 0.0, 0.0])
    terminal = 100.0 * np.array([34.0, 34.0, 3.0, 10.4, 10.4, 10.4])  # Of the uniform preferences.
    assert report.closed_loop_cost == pytest.approx(before + terminal @ errors**2)


def test_a_solve_that_stops_early_is_driven_with_and_is_no_failure(problem):
    bench = ControllerBench(problem, solver=HurriedSolver(MakeSolver("snopt", problem)))
    bench.send(GO)
    bench.tick()
    report = bench.output("leg_report")
    assert report.outcome is Outcome.RUNNING
    assert (report.solves, report.failures, report.not_converged) == (1, 0, 1)
    assert bench.output("control")[0] > 0.1


def test_one_iteration_a_sample_is_driven_with(problem):
    bench = ControllerBench(problem, solver=MakeSolver("rti", problem, sqp_iterations=1))
    bench.place([0.0, 0.5, 0.9, 1.0, 0.2, 0.3])
    bench.send(GO)
    bench.tick()
    report = bench.output("leg_report")
    assert (report.solves, report.failures, report.not_converged) == (1, 0, 1)
    assert tuple(bench.output("control")) != mut.PARKED


def test_carrying_something_it_accelerates_less(problem):
    controls = []
    for held in ((), (("pharmacy_north/med_antibiotic", 0),)):
        bench = ControllerBench(problem)
        bench.magnet.GetMutableData().set_value(MagnetCommand(held))
        bench.send(GO)
        bench.place([0.0, 0.0, 0.0, 1.4, 0.0, 0.0])
        bench.tick()
        states = np.array(bench.output("predicted_trajectory").states)
        controls.append(states)
    assert not np.allclose(controls[0], controls[1])
