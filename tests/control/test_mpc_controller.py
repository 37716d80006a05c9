"""The controller alone, its inputs fixed: what it does when all is well, and when something is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

from mala_drake.clock import TICK
from mala_drake.control import mpc_controller as mut
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.control.solution import Status
from mala_drake.control.solver import MakeSolver
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.messages import (
    Action,
    ActionKind,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    MagnetCommand,
    Obstacles,
    Outcome,
    Preferences,
    Shape,
)
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.ward_map import Ward

HALL = Ward("hall", 10.0, 0.2, 2.0, (), (), (), 0.02)
THERE = (6.0, 0.0, 0.0)
GO = Action(1, ActionKind.MOVE, "go_to_there", ("robot1",), "there")


class FailingSolver:
    """Wraps a solver and lets its results fail from the given solve on, for the given number of solves."""

    name = "failing"

    def __init__(self, solver, first, count):
        self._solver, self._failing, self._calls = solver, range(first, first + count), 0

    def solve(self, initial_state, parameters, warm_start=None):
        self._calls += 1
        state = np.full(6, np.nan) if self._calls in self._failing else initial_state
        return self._solver.solve(state, parameters, warm_start)


class HurriedSolver:
    """Wraps a solver and says of each result that it was stopped early."""

    name = "hurried"

    def __init__(self, solver):
        self._solver = solver

    def solve(self, initial_state, parameters, warm_start=None):
        return replace(self._solver.solve(initial_state, parameters, warm_start), status=Status.ITERATION_LIMIT)


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


class Bench:
    """A controller on a simulator, with handles to its inputs."""

    def __init__(self, problem, *, solver=None, rules=None):
        congestion = Congestion(HALL)
        self.system = mut.MpcController(
            targets={"there": THERE},
            guide=LegGuide(LegPlanner(HALL), congestion, HALL.shapes, rules or LegRules()),
            congestion=congestion,
            problem=problem,
            solver=solver or MakeSolver("snopt", problem),
        )
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        fix = lambda name, value: self.system.GetInputPort(name).FixValue(self.context, value)  # noqa: E731
        self.robot_state = fix("robot_state", np.zeros(6))
        self.action = fix("action", Value(Action()))
        self.obstacles = fix("obstacles", Value(Obstacles()))
        self.charge = fix("charge", [1.0])
        self.preferences = fix("preferences", Value(Preferences()))
        self.magnet = fix("magnet", Value(MagnetCommand()))
        self.ticks = 0

    def send(self, action):
        self.action.GetMutableData().set_value(action)

    def place(self, state):
        self.robot_state.GetMutableData().get_mutable_value().SetFromVector(state)

    def tick(self, count=1):
        self.ticks += count
        self.simulator.AdvanceTo(self.ticks * TICK)

    def output(self, name):
        return self.system.GetOutputPort(name).Eval(self.context)


@pytest.fixture
def bench(problem):
    return Bench(problem)


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


def test_a_failed_solve_brakes_and_the_next_one_goes_on(problem):
    bench = Bench(problem, solver=FailingSolver(MakeSolver("snopt", problem), 2, 1))
    bench.send(GO)
    bench.tick()
    bench.tick()
    assert tuple(bench.output("control")) == mut.PARKED
    report = bench.output("leg_report")
    assert (report.failures, report.not_converged) == (1, 0)
    bench.tick()
    assert bench.output("control")[0] > 0.1
    assert bench.output("leg_report").outcome is Outcome.RUNNING


def test_a_solve_that_stops_early_is_driven_with_and_is_no_failure(problem):
    bench = Bench(problem, solver=HurriedSolver(MakeSolver("snopt", problem)))
    bench.send(GO)
    bench.tick()
    report = bench.output("leg_report")
    assert report.outcome is Outcome.RUNNING
    assert (report.solves, report.failures, report.not_converged) == (1, 0, 1)
    assert bench.output("control")[0] > 0.1


def test_one_iteration_a_sample_is_driven_with(problem):
    bench = Bench(problem, solver=MakeSolver("rti", problem, sqp_iterations=1))
    bench.place([0.0, 0.5, 0.9, 1.0, 0.2, 0.3])
    bench.send(GO)
    bench.tick()
    report = bench.output("leg_report")
    assert (report.solves, report.failures, report.not_converged) == (1, 0, 1)
    assert tuple(bench.output("control")) != mut.PARKED


def test_a_solver_that_keeps_failing_is_reported(problem):
    rules = LegRules(tolerated_failures=3)
    bench = Bench(problem, solver=FailingSolver(MakeSolver("snopt", problem), 1, 1000), rules=rules)
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
    assert bench.output("leg_report").outcome is Outcome.RUNNING
    bench.tick(5)
    assert bench.output("leg_report").outcome is Outcome.INVALID_STATE


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


def test_carrying_something_it_accelerates_less(problem):
    controls = []
    for held in ((), (("pharmacy_north/med_antibiotic", 0),)):
        bench = Bench(problem)
        bench.magnet.GetMutableData().set_value(MagnetCommand(held))
        bench.send(GO)
        bench.place([0.0, 0.0, 0.0, 1.4, 0.0, 0.0])
        bench.tick()
        states = np.array(bench.output("predicted_trajectory").states)
        controls.append(states)
    assert not np.allclose(controls[0], controls[1])


@pytest.mark.parametrize("learned", [None, LearnedTargets(), LearnedTargets((("elsewhere", 1.0, 1.0),), 1)])
def test_where_nothing_is_learned_the_map_says_where_a_leg_ends(bench, learned):
    if learned is not None:
        bench.system.GetInputPort("learned_targets").FixValue(bench.context, Value(learned))
    bench.send(GO)
    bench.place([THERE[0], THERE[1] + 0.03, 0.0, 0.0, 0.0, 0.0])
    bench.tick(2)
    assert bench.output("leg_report").position_error == pytest.approx(0.03)


def test_a_leg_ends_at_its_learned_target_and_is_judged_by_it(bench):
    learned = LearnedTargets((("there", 4.0, 2.0),), 1)
    bench.system.GetInputPort("learned_targets").FixValue(bench.context, Value(learned))
    bench.send(GO)
    bench.place([4.0, 1.96, 0.0, 0.0, 0.0, 0.0])
    bench.tick(2)
    report = bench.output("leg_report")
    assert report.outcome is Outcome.SUCCESS
    assert report.position_error == pytest.approx(0.04)


def test_a_target_learned_under_way_is_for_the_next_leg(bench):
    port = bench.system.GetInputPort("learned_targets").FixValue(bench.context, Value(LearnedTargets()))
    bench.send(GO)
    bench.tick()
    port.GetMutableData().set_value(LearnedTargets((("there", 4.0, 2.0),), 1))
    bench.place([THERE[0], THERE[1] + 0.03, 0.0, 0.0, 0.0, 0.0])
    bench.tick(2)
    report = bench.output("leg_report")
    assert (report.outcome, report.position_error) == (Outcome.SUCCESS, pytest.approx(0.03))


class ListeningSolver:
    """Wraps a solver and keeps the model and the stage cost that each solve is given."""

    name = "listening"

    def __init__(self, solver):
        self._solver, self.models, self.stages = solver, [], []

    def solve(self, initial_state, parameters, warm_start=None):
        self.models.append(parameters.dynamics)
        self.stages.append(parameters.stage)
        return self._solver.solve(initial_state, parameters, warm_start)


def test_a_learned_model_is_predicted_with_from_the_next_solve_on(problem):
    solver = ListeningSolver(MakeSolver("rti", problem))
    bench = Bench(problem, solver=solver)
    port = bench.system.GetInputPort("learned_dynamics").FixValue(bench.context, Value(LearnedDynamics()))
    bench.send(GO)
    bench.tick(2)
    learned = LearnedDynamics((7.0, -0.07, 0.35, 0.94, 0.98, 0.93), (0.1,) * 6, updates=20)
    port.GetMutableData().set_value(learned)
    bench.tick()
    nominal = DynamicsParameters()
    assert solver.models == [nominal, nominal, DynamicsParameters(*learned.coefficients)]


def test_learned_weights_are_for_the_next_leg(problem):
    solver = ListeningSolver(MakeSolver("rti", problem))
    bench = Bench(problem, solver=solver)
    port = bench.system.GetInputPort("learned_weights").FixValue(bench.context, Value(LearnedWeights()))
    bench.send(GO)
    bench.tick()
    gains = 0.5 * DEFAULT_TRANSLATION.gains
    learned = LearnedWeights((("there", (2.0, 1.0, 1.0, 0.5)),), tuple(map(tuple, gains.tolist())))
    port.GetMutableData().set_value(learned)
    bench.tick()
    bench.send(replace(GO, sequence=2))
    bench.tick()
    first, same, last = solver.stages
    np.testing.assert_array_equal(first.state_weights, same.state_weights)
    # The preferences are uniform, so that the gains have no effect; the factors have.
    np.testing.assert_allclose(last.state_weights, first.state_weights * [2.0, 2.0, 1.0, 1.0, 1.0, 1.0])
    np.testing.assert_allclose(last.control_weights, 0.5 * first.control_weights)


def test_a_learned_translation_translates_the_preferences(problem):
    solver = ListeningSolver(MakeSolver("rti", problem))
    bench = Bench(problem, solver=solver)
    weights = (0.4, 0.3, 0.1, 0.1, 0.1)
    bench.preferences.GetMutableData().set_value(Preferences(estimate=weights))
    gains = 0.5 * DEFAULT_TRANSLATION.gains
    learned = LearnedWeights(gains=tuple(map(tuple, gains.tolist())))
    bench.system.GetInputPort("learned_weights").FixValue(bench.context, Value(learned))
    bench.send(GO)
    bench.tick()
    state_weights, control_weights = CostTranslation.of(gains)(weights)
    np.testing.assert_allclose(solver.stages[0].state_weights, state_weights)
    np.testing.assert_allclose(solver.stages[0].control_weights, control_weights)


def test_a_weaker_robot_is_driven_with_more_propulsion(problem):
    controls = []
    for gain in (1.0, 0.8):
        bench = Bench(problem, solver=MakeSolver("rti", problem))
        learned = LearnedDynamics((5.0, 0.0, 0.0, gain, 1.0, 1.0), (0.1,) * 6, updates=20)
        bench.system.GetInputPort("learned_dynamics").FixValue(bench.context, Value(learned))
        bench.place([3.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        bench.send(GO)
        bench.tick()
        controls.append(tuple(bench.output("control")))
    assert controls[1][0] - controls[1][1] > controls[0][0] - controls[0][1] + 0.01
