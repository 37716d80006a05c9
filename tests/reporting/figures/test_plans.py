"""What the pictures of plans are drawn from."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mala_drake.reporting.figures import plans as mut
from mala_drake.reporting.profile_results import profile_results
from mala_drake.reporting.results import load_results

MEALS = ("salad/left", "salad/right", "hot_meal/right", "salad/left", "sandwich/left")


@pytest.fixture
def figures(tmp_path, simulate_results):
    """Five meals, of which the last one failed, between rounds of medicine."""

    def serve(record):
        if record.task == "medication":
            return record
        meal = record.episode // 2
        return replace(record, plan_variant=MEALS[meal], success=meal < 4, failure=None if meal < 4 else "blocked")

    tasks = ("medication", "meal")
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=10, tasks=tasks, change=serve)
    (found,) = profile_results(load_results(tmp_path), "")
    return found


def test_dishes_share_the_delivered_meals_wherever_they_were_put(figures):
    shares = mut.dish_shares(figures)
    assert list(shares.items()) == [("hot_meal", 0.25), ("salad", 0.75)]


def test_where_no_meal_was_delivered_there_is_nothing_to_share(figures):
    rounds = tuple(replace(run, episodes=run.of_task("medication")) for run in figures.runs)
    assert mut.dish_shares(replace(figures, runs=rounds)) == {}
