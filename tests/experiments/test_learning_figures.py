"""How well wishes were learned in a run, against figures counted by hand."""

from __future__ import annotations

import math

import pytest

from mala_drake.experiments import learning_figures as mut


@pytest.fixture
def records(episode_record):
    unrated = {"ratings": [None] * 5}
    distances = (0.1, 0.05, 0.6, 0.14, 0.12, 0.2)
    return [
        episode_record(episode=n, distance_to_true=distance, **(unrated if n == 3 else {}))
        for n, distance in enumerate(distances)
    ]


def test_without_a_change_of_mind_every_episode_counts(records):
    assert mut.learning_figures(records, earlier_episodes=0) == mut.LearningFigures(1, 0.05, 0.2)


def test_what_was_known_of_earlier_wishes_does_not_count(records):
    # The second episode since is near enough, but was not rated.
    assert mut.learning_figures(records, earlier_episodes=2) == mut.LearningFigures(2, 0.12, 0.2)


@pytest.mark.parametrize("earlier", [6, 9])
def test_before_the_change_of_mind_there_is_nothing_to_tell(records, earlier):
    found = mut.learning_figures(records, earlier_episodes=earlier)
    assert found.convergence_episode is None
    assert math.isnan(found.best_distance)
    assert math.isnan(found.final_distance)
