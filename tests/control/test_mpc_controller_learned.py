"""The controller alone, told what was learned: targets, the model, and weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pydrake.common.value import Value

from mala_drake.control.parameters import DynamicsParameters
from mala_drake.control.solver import MakeSolver
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.messages import LearnedDynamics, LearnedTargets, LearnedWeights, Outcome, Preferences

from .controller_bench import GO, THERE, ControllerBench


class ListeningSolver:
    """Wraps a solver and keeps the model and the stage cost that each solve is given."""

    name = "listening"

    def __init__(self, solver):
        self._solver, self.models, self.stages = solver, [], []

    def solve(self, initial_state, parameters, warm_start=None):
        self.models.append(parameters.dynamics)
        self.stages.append(parameters.stage)
        return self._solver.solve(initial_state, parameters, warm_start)


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


def test_a_learned_model_is_predicted_with_from_the_next_solve_on(problem):
    solver = ListeningSolver(MakeSolver("rti", problem))
    bench = ControllerBench(problem, solver=solver)
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
    bench = ControllerBench(problem, solver=solver)
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
    bench = ControllerBench(problem, solver=solver)
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
        bench = ControllerBench(problem, solver=MakeSolver("rti", problem))
        learned = LearnedDynamics((5.0, 0.0, 0.0, gain, 1.0, 1.0), (0.1,) * 6, updates=20)
        bench.system.GetInputPort("learned_dynamics").FixValue(bench.context, Value(learned))
        bench.place([3.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        bench.send(GO)
        bench.tick()
        controls.append(tuple(bench.output("control")))
    assert controls[1][0] - controls[1][1] > controls[0][0] - controls[0][1] + 0.01
