import pytest

from mala_drake.errors import BadInput
from mala_drake.learning import LEARNER_NAMES, FixedWeights, Posterior, ProjectedGradient, make_learner
from mala_drake.scenario import LearnerConfig

WEIGHTS = [0.3, 0.3, 0.2, 0.1, 0.1]


@pytest.mark.parametrize("name", LEARNER_NAMES)
def test_every_name_makes_a_learner_that_learns(name):
    learner = make_learner(LearnerConfig(name=name))
    state = learner.update(learner.initial_state(), ratings=(4.0,) * 5, features=(0.5,) * 5)
    assert learner.updates(state) == 1


def test_the_default_is_the_posterior():
    assert make_learner(LearnerConfig()) == Posterior()
    assert LEARNER_NAMES[0] == LearnerConfig().name


def test_the_settings_arrive():
    config = LearnerConfig("projected_gradient", WEIGHTS, learning_rate=0.1, exploration=0.2, exploration_decay=0.0)
    paper = ProjectedGradient(initial_weights=tuple(WEIGHTS), step_size=0.1, exploration=0.2, exploration_decay=0.0)
    assert make_learner(config) == paper
    config.name = "reference_gradient"
    variant = make_learner(config)
    assert (variant.step_size, variant.step_decay, variant.mixing, variant.learn_bias) == (0.1, 0.15, 0.6, True)
    assert make_learner(LearnerConfig("fixed", WEIGHTS)) == FixedWeights(weights=tuple(WEIGHTS))
    assert make_learner(LearnerConfig(exploration_until=0.5)) == Posterior(exploration_until=0.5)


def test_what_does_not_fit_is_refused_with_its_place():
    with pytest.raises(BadInput, match=r"here: learner\.name"):
        make_learner(LearnerConfig(name="oracle"), where="here: learner")
    with pytest.raises(BadInput, match="initial_weights"):
        make_learner(LearnerConfig("posterior", WEIGHTS))
