"""A leg recorded in a hall, against differences of its parameters."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.control.sensitivities.recorded_leg as mut
from mala_drake.clock import TICK
from mala_drake.control.action_parameters import EMPTY_HANDED
from mala_drake.control.leg import LegRules
from mala_drake.control.mpc_controller import MpcController
from mala_drake.control.sensitivities import LOWER, UPPER, SensitivityAnalysis
from mala_drake.control.solution import invalid_solution
from mala_drake.control.solver_by_horizon import SHORTEST_HORIZON, solver_of_kind
from mala_drake.messages import Action, ActionKind, MagnetCommand, Obstacles, Preferences

from .hall import HALL, THERE, make, make_guide


def record(problem, rules=None, *, kind="receding"):
    return make(mut.LegRecorder, problem, rules, kind=kind).record(
        np.zeros(6), THERE, HALL.shapes, style=EMPTY_HANDED, weights=(0.2,) * 5
    )


@pytest.fixture(scope="module")
def leg(problem):
    return record(problem)


def test_it_begins_where_it_is_told_and_ends_at_its_target(leg):
    np.testing.assert_array_equal(leg.initial_state, np.zeros(6))
    np.testing.assert_allclose(leg.steps[-1].terminal.target[:2], THERE[:2], atol=1e-9)
    assert (leg.shares[0][0], leg.shares[-1][-1]) == (0.0, 1.0)


class Listener:
    """Wraps a solver and keeps the parameters that it is given."""

    def __init__(self, solver):
        self.name, self._solver, self.parameters = solver.name, solver, []

    def solve(self, initial_state, parameters, warm_start=None):
        self.parameters.append(parameters)
        return self._solver.solve(initial_state, parameters, warm_start)


def driven(problem, kind):
    """The parameters of the solves of a controller that drives the leg, on a robot that is as its model says."""
    solver, shortest = solver_of_kind(kind, "rti", problem)
    listener = Listener(solver)
    guide, congestion = make_guide()
    controller = MpcController(
        targets={"there": THERE},
        guide=guide,
        congestion=congestion,
        problem=problem,
        solver=listener,
        shortest_horizon=shortest,
    )
    simulator = Simulator(controller)
    context = simulator.get_mutable_context()
    state = np.zeros(6)
    values = {
        "robot_state": state,
        "action": Value(Action(1, ActionKind.MOVE, "go_to_there", ("robot1",), "there")),
        "obstacles": Value(Obstacles(HALL.shapes)),
        "charge": [1.0],
        "preferences": Value(Preferences(estimate=(0.2,) * 5)),
        "magnet": Value(MagnetCommand()),
    }
    ports = {name: controller.GetInputPort(name).FixValue(context, value) for name, value in values.items()}
    for tick in range(1, 200):
        simulator.AdvanceTo(tick * TICK)
        if controller.GetOutputPort("leg_report").Eval(context).finished:
            break
        control = controller.GetOutputPort("control").Eval(context)
        state = problem.step(state, control, listener.parameters[-1].dynamics.vector).full()[:, 0]
        ports["robot_state"].GetMutableData().get_mutable_value().SetFromVector(state)
    return listener.parameters


@pytest.mark.parametrize("kind", ["receding", "shrinking"])
def test_it_is_recorded_as_the_controller_drives_it(problem, kind):
    ours, theirs = record(problem, kind=kind).steps, driven(problem, kind)
    assert len(ours) == len(theirs)
    assert [step.horizon for step in ours] == [step.horizon for step in theirs]
    for step, other in zip(ours, theirs, strict=True):
        own = problem.of_horizon(step.horizon)
        np.testing.assert_array_equal(own.pack(np.zeros(6), step), own.pack(np.zeros(6), other))


def test_a_horizon_that_shrinks_is_recorded_with_the_references_up_to_its_end(problem):
    leg = record(problem, kind="shrinking")
    horizons = [step.horizon for step in leg.steps]
    assert problem.horizon >= horizons[0] > 2 * SHORTEST_HORIZON
    assert min(horizons) == horizons[-1] == SHORTEST_HORIZON
    assert [len(shares) for shares in leg.shares] == [horizon + 1 for horizon in horizons]


def test_a_leg_that_does_not_succeed_is_an_error(problem):
    with pytest.raises(RuntimeError, match=r"^ended as step_budget: 3 control steps"):
        record(problem, LegRules(step_budget=3))


def test_a_solve_that_no_robot_is_driven_with_is_an_error(problem):
    class Broken:
        name = "broken"

        def solve(self, *_):
            return invalid_solution(problem.layout)

    recorder = mut.LegRecorder(problem, Broken(), *make_guide())
    with pytest.raises(RuntimeError, match=r"^ended as solver_failure: a solve ended as invalid_input$"):
        recorder.record(np.zeros(6), THERE, HALL.shapes, style=EMPTY_HANDED, weights=(0.2,) * 5)


@pytest.mark.parametrize("kind", ["receding", "shrinking"])
def test_the_derivatives_of_the_parameters_are_differences(problem, kind):
    leg = record(problem, kind=kind)
    columns = SensitivityAnalysis(problem).columns

    def columns_at(step, knobs):
        chosen = leg.with_knobs(knobs, columns).at(step, leg.initial_state).parameters
        own, places = problem.of_horizon(chosen.horizon), columns.of_horizon(chosen.horizon)
        values = np.zeros(places.parameters.stop)
        values[: own.layout.size] = own.pack(leg.initial_state, chosen)
        values[places.slices[LOWER]], values[places.slices[UPPER]] = chosen.inputs.lower, chosen.inputs.upper
        return values

    base = np.array([0.1, -0.2, 1.1, 0.9])
    for step in (0, 10, len(leg.steps) + 5):  # The last parameters stay.
        schedule = leg.with_knobs(base, columns)
        by_knobs = schedule.at(step, leg.initial_state).by_knobs
        for i in range(schedule.knobs):
            ends = [columns_at(step, base + size * np.eye(4)[i]) for size in (1e-6, -1e-6)]
            np.testing.assert_allclose(by_knobs[:, i], (ends[0] - ends[1]) / 2e-6, atol=1e-5)
