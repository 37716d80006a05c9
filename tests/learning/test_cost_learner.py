import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.learning.cost_learner as mut
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.messages import Action, ActionFeatures, ActionKind, LearnedCosts, Outcome

CHECK = ("check-time",)


def checked(sequence, seconds, outcome=Outcome.SUCCESS):
    action = Action(sequence, ActionKind.IN_PLACE, "check_medication_correct", ("robot1", "pharmacy_north"))
    return ActionFeatures(action, outcome, duration=seconds, charge_used=0.02)


class Run:
    """A cost learner in a simulation, which is told of one action after another."""

    def __init__(self):
        self.learner = CostEstimator({CHECK: 2.0, ("check-battery",): 0.02})
        self.system = mut.CostLearner(learner=self.learner)
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._port = self.system.GetInputPort("action_features").FixValue(self.context, Value(ActionFeatures()))

    def after(self, features=None) -> LearnedCosts:
        if features is not None:
            self._port.GetMutableData().set_value(features)
        self.simulator.AdvanceTo(self.context.get_time() + 1.0)
        return self.system.GetOutputPort("learned_costs").Eval(self.context)


@pytest.fixture
def run():
    return Run()


def test_drawn_ports_are_the_real_ports(run, assert_port_box):
    assert_port_box(run.system)


def test_before_any_action_nothing_is_learned(run):
    assert run.after() == LearnedCosts()


def test_actions_are_learned_from_as_the_plain_class_does(run):
    state = run.learner.initial_state()
    for sequence, seconds in enumerate((2.6, 2.4, 2.2), start=1):
        state = run.learner.update(state, {CHECK: seconds, ("check-battery",): 0.02})
        assert run.after(checked(sequence, seconds)) == run.learner.learned(state)
    assert dict(run.learner.learned(state).values)[CHECK] == pytest.approx((2.0 + 2.6 + 2.4 + 2.2) / 4)


def test_an_action_is_learned_from_once_however_long_it_stands(run):
    once = run.after(checked(1, 3.0))
    assert run.after() == once
    assert run.after(checked(1, 9.0)) == once


def test_a_failed_action_teaches_nothing(run):
    assert run.after(checked(1, 9.0, Outcome.NOT_THERE)) == LearnedCosts()
    assert run.after(checked(2, 3.0)).updates == 1


def test_what_was_learned_goes_on_in_a_fresh_context(run):
    learned = run.after(checked(5, 3.0))
    state = run.system.learner_state(run.context)
    later = Run()
    later.system.set_learner_state(later.context, state, episode=1)
    assert later.after() == learned
    assert later.after(checked(1, 3.0)).updates == 2  # Actions are counted anew in each episode.


def test_its_state_is_numbers(run):
    run.after(checked(1, 3.0))
    assert run.context.num_abstract_states() == 0
    assert np.all(np.isfinite(run.context.get_discrete_state_vector().value()))
