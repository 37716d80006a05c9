import pytest

from mala_drake.learning import convergence_episode, preference_distance


def test_the_distance_is_euclidean():
    assert preference_distance((1.0, 0.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0, 0.0)) == pytest.approx(2**0.5)


def test_the_first_rated_episode_counts_as_one():
    assert convergence_episode([0.15, 0.4]) == 1
    assert convergence_episode([0.3, 0.2, 0.149, 0.3]) == 3


def test_a_run_may_never_converge():
    assert convergence_episode([0.3, 0.2]) is None
    assert convergence_episode([]) is None


def test_a_distance_that_is_not_a_number_is_no_convergence():
    assert convergence_episode([float("nan"), 0.1]) == 2


def test_the_threshold_can_be_chosen():
    assert convergence_episode([0.3, 0.2], threshold=0.25) == 2
