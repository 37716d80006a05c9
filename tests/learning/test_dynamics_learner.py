import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

import mala_drake.learning.dynamics_learner as mut
from mala_drake.clock import TICK
from mala_drake.control.model import step_function
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.messages import LearnedDynamics

STEP = step_function(TICK)
TRUTH = np.array([7.0, -0.07, 0.35, 0.94, 0.98, 0.93])


class Run:
    """A dynamics learner in a simulation, beside a robot of known dynamics."""

    def __init__(self):
        self.learner = DynamicsEstimator()
        self.system = mut.DynamicsLearner(learner=self.learner)
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self.state = np.array([0.0, 0.0, 0.0, 0.8, 0.0, 0.1])
        self.control = np.array([0.1, 0.0, 0.1])
        self._state_port = self.system.GetInputPort("robot_state").FixValue(self.context, self.state)
        self._control_port = self.system.GetInputPort("control").FixValue(self.context, self.control)
        self._ticks = 0

    def tick(self, control) -> LearnedDynamics:
        """The robot has done what it was last told; it is told `control` now, and the learner looks at both."""
        self.control = np.array(control)
        self._state_port.GetMutableData().set_value(self.state)
        self._control_port.GetMutableData().set_value(self.control)
        self._ticks += 1
        self.simulator.AdvanceTo(self._ticks * TICK)
        self.state = np.array(STEP(self.state, self.control, TRUTH)).ravel()
        return self.system.GetOutputPort("learned_dynamics").Eval(self.context)

    def drive(self, ticks):
        transitions = []
        for i in range(ticks):
            control = np.array([0.5 * (1 + np.sin(i)), 0.4, np.cos(0.7 * i)])
            before, learned = self.state, self.tick(control)
            transitions.append(Transition(before, control, self.state))
        # What the last tick did is seen only at the next one.
        return transitions[:-1], learned


@pytest.fixture
def run():
    return Run()


def test_drawn_ports_are_the_real_ports(run, assert_port_box):
    assert_port_box(run.system)


def test_before_the_robot_has_moved_nothing_is_learned(run):
    assert run.tick((0.1, 0.0, 0.1)) == LearnedDynamics()


def test_it_learns_as_the_plain_class_does(run):
    transitions, learned = run.drive(40)
    state = run.learner.initial_state()
    for transition in transitions:
        state = run.learner.update(state, transition)
    assert learned == run.learner.learned(state)
    assert learned.updates > 30
    assert learned.coefficients[3] == pytest.approx(TRUTH[3], rel=0.02)


def test_what_was_learned_goes_on_in_a_fresh_context_and_the_log_does_not(run):
    _, learned = run.drive(30)
    state = run.system.learner_state(run.context)
    later = Run()
    later.system.set_learner_state(later.context, state, episode=1)
    assert later.tick((0.9, 0.0, 0.3)) == learned
    assert later.tick((0.5, 0.0, 0.3)).updates == learned.updates + 1


def test_a_state_that_is_not_finite_teaches_nothing(run):
    _, learned = run.drive(20)
    run.tick((0.5, 0.0, 0.3))
    known = run.system.learner_state(run.context)
    run.state = np.full(6, np.nan)
    run.tick((0.5, 0.0, 0.3))
    run.state = np.array([0.0, 0.0, 0.0, 0.8, 0.0, 0.1])
    run.tick((0.5, 0.0, 0.3))
    assert learned.updates > 0
    assert np.array_equal(run.system.learner_state(run.context), known)


def test_its_state_is_numbers(run):
    run.drive(5)
    assert run.context.num_abstract_states() == 0
    assert np.all(np.isfinite(run.context.get_discrete_state_vector().value()))
