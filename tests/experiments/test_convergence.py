"""The convergence experiment: learners side by side, the first as the main condition."""

from __future__ import annotations

from mala_drake.experiments import convergence as mut
from mala_drake.learning.make_learner import LEARNER_NAMES
from mala_drake.scenario import LearnerConfig, Scenario


def test_the_first_learner_is_the_main_condition_and_the_others_have_their_names():
    assert mut.learner_conditions(Scenario(), ("bandit", "fixed")) == {
        "": {"learner": {"name": "bandit"}},
        "fixed": {"learner": {"name": "fixed"}},
    }


def test_without_names_it_is_the_scenarios_own_learner():
    base = Scenario(learner=LearnerConfig(name="random"))
    assert mut.learner_conditions(base, None) == {"": {"learner": {"name": "random"}}}


def test_any_learner_can_be_named():
    assert mut.CONVERGENCE.condition_names == LEARNER_NAMES
    assert set(mut.learner_conditions(Scenario(), LEARNER_NAMES)) == {"", *LEARNER_NAMES[1:]}
