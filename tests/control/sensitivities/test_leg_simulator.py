"""A leg simulated as it was driven, against a controller's own pieces put together by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.sensitivities.leg_simulator as mut
from mala_drake.control.action_parameters import CARRYING, EMPTY_HANDED
from mala_drake.control.leg import LegRules
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.control.sensitivities import ScheduledParameters
from mala_drake.control.sensitivities.recorded_leg import NOMINAL, LegRecorder
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.messages import DrivenLeg, LearnedDynamics, LearnedWeights, Shape

from .hall import GO, make

BEGAN = (0.1, 0.0, 0.2, 0.0, 0.0, 0.0)
LEG = DrivenLeg(GO, BEGAN, (1.5, 0.4, 0.3), preferences=(0.5, 0.12, 0.14, 0.14, 0.10))
COEFFICIENTS = (4.0, 0.1, 0.2, 0.9, 0.9, 0.8)
GAINS = 0.5 * DEFAULT_TRANSLATION.gains
LEARNED = LearnedWeights((("there", (2.0, 1.0, 0.5, 1.5)),), tuple(map(tuple, GAINS.tolist())))
TROLLEY = (Shape("trolley", 0.8, 0.15, radius=0.2),)


def simulated(problem, leg, rules=None):
    """The run of a leg, and the parameters of its steps."""
    seen = []

    def schedule(recorded, columns):
        seen.extend(recorded.steps)
        return recorded.with_knobs(NOMINAL, columns)

    return make(mut.LegSimulator, problem, rules)(leg, schedule), seen


@pytest.mark.parametrize(
    ("how", "expected"),
    [
        ({}, {"style": EMPTY_HANDED}),
        ({"carrying": True}, {"style": CARRYING}),
        ({"dynamics": LearnedDynamics(COEFFICIENTS, (0.1,) * 6, 9)}, {"dynamics": DynamicsParameters(*COEFFICIENTS)}),
        (
            {"weights": LEARNED},
            {
                "style": replace(EMPTY_HANDED, position_weight=2.0, velocity_weight=0.5, control_weight=1.5),
                "translation": CostTranslation.of(GAINS),
            },
        ),
        ({"obstacles": TROLLEY}, {"obstacles": TROLLEY}),
    ],
    ids=["plain", "carrying", "dynamics", "weights", "obstacles"],
)
def test_it_is_driven_with_what_the_real_leg_was_driven_with(problem, how, expected):
    run, steps = simulated(problem, replace(LEG, **how))
    by_hand = {"style": EMPTY_HANDED, "obstacles": (), "weights": LEG.preferences, **expected}
    recorded = make(LegRecorder, problem).record(BEGAN, LEG.target, **by_hand)
    assert len(run.steps) == len(steps) == len(recorded.steps)
    np.testing.assert_array_equal(run.states[0], BEGAN)
    for ours, theirs in zip(steps, recorded.steps, strict=True):
        np.testing.assert_array_equal(problem.pack(np.zeros(6), ours), problem.pack(np.zeros(6), theirs))
    # The closed loop over the model that the controller believes in goes as the leg was recorded.
    first = problem.step(run.states[0], run.controls[0], steps[0].dynamics.vector).full()[:, 0]
    np.testing.assert_allclose(run.states[1], first, atol=1e-9)
    np.testing.assert_allclose(run.states[-1][:2], LEG.target[:2], atol=0.1)


def test_its_knobs_are_those_of_the_schedule(problem):
    def two_knobs(recorded, columns):
        whole = recorded.with_knobs(NOMINAL, columns)
        steps = [whole.at(i, np.zeros(6)) for i in range(len(recorded.steps))]
        return ScheduledParameters([replace(step, by_knobs=step.by_knobs[:, :2]) for step in steps], whole.groups)

    run = make(mut.LegSimulator, problem)(LEG, two_knobs)
    assert {step.policy_by_knobs.shape for step in run.steps} == {(3, 2)}


def test_a_leg_that_fails_in_simulation_is_an_error(problem):
    with pytest.raises(RuntimeError, match=r"^ended as step_budget: 3 control steps"):
        simulated(problem, LEG, LegRules(step_budget=3))


def test_a_leg_with_no_way_is_an_error(problem):
    with pytest.raises(RuntimeError, match=r"^ended as blocked: no free way: trolley"):
        simulated(problem, replace(LEG, obstacles=(Shape("trolley", 1.5, 0.4, radius=0.3),)))
