"""The figures of the convergence table against figures counted by hand."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.reporting.profile_results import dominant, profile_results
from mala_drake.reporting.quantiles import Spread, spread
from mala_drake.reporting.results import load_results

DISTANCES = {0: [0.3, 0.2, 0.14, 0.16], 1: [0.1, 0.05, 0.04, 0.05], 2: [0.3, 0.3, 0.2, 0.2]}
"""By seed. With the second episode of seed 0 unrated, that run converges after two rated episodes."""


def by_hand(record):
    changed = replace(
        record,
        distance_to_true=DISTANCES[record.seed][record.episode],
        weights_after=[0.4, 0.3, 0.1, 0.1, 0.1] if record.seed < 2 else [0.3, 0.4, 0.1, 0.1, 0.1],
        plan_variant="a" if record.episode < 3 else f"b{record.seed}",
        features={"time": 0.5, "safety": 0.0, "battery": 1.0, "proximity": 0.0, "approach": 0.1 * record.seed},
    )
    if (record.seed, record.episode) == (0, 1):
        changed = replace(changed, ratings=[None] * 5)
    if (record.seed, record.episode) == (2, 3):
        so_far = dict.fromkeys(changed.features, 0.01)  # What was measured until it failed.
        changed = replace(changed, success=False, failure="blocked", collisions=2, features=so_far)
    return changed


@pytest.fixture
def figures(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=DISTANCES, change=by_hand)
    (found,) = profile_results(load_results(tmp_path), "")
    return found


def test_convergence_counts_rated_episodes(figures):
    assert figures.convergence_episodes == (2, 1, None)
    assert figures.converged == 2
    assert figures.convergence == Spread(2.0, 1.5, math.inf)


def test_best_and_final_distance(figures):
    assert figures.best_distance == Spread(0.14, pytest.approx(0.09), pytest.approx(0.17))
    assert figures.final_distance == Spread(0.16, pytest.approx(0.105), pytest.approx(0.18))


def test_the_dominant_preference_is_counted_by_run(figures):
    assert dominant(PROFILES["speed_oriented"]) == {"time"}
    assert figures.dominant_right == 2


@pytest.mark.parametrize(
    ("wanted", "right"),
    [
        ((0.3, 0.3, 0.2, 0.1, 0.1), 2),  # The greatest weights learned are time's and safety's.
        ((0.1, 0.3, 0.3, 0.1, 0.2), 1),
        ((0.2, 0.2, 0.2, 0.2, 0.2), None),
    ],
)
def test_any_of_several_greatest_wishes_is_right_and_even_wishes_have_none(figures, wanted, right):
    assert replace(figures, runs=figures.runs[1:], true_weights=wanted).dominant_right == right


def test_weights_that_are_even_name_no_criterion(figures):
    run = figures.runs[0]
    even = replace(run, episodes=(replace(run.final, weights_after=[0.2] * 5),))
    assert replace(figures, runs=(even,)).dominant_right == 0
    assert replace(figures, runs=(even,), true_weights=(0.3, 0.3, 0.2, 0.1, 0.1)).dominant_right == 0


def test_success_collisions_and_variants_are_counted_by_episode(figures):
    assert (figures.episodes, figures.successes, figures.collisions) == (12, 11, 2)
    assert figures.variants() == {"a": 9, "b0": 1, "b1": 1}  # That of the failed episode was not executed to its end.
    assert figures.variants("meal") == {}


def test_the_cost_to_the_patient_weighs_measured_features_with_true_weights(figures):
    assert figures.cost.median == pytest.approx(0.5 * 0.50 + 1.0 * 0.14 + 0.1 * 0.10)


def test_a_failure_costs_nothing_and_is_no_saving(figures):
    failed = replace(figures, runs=figures.runs[2:])
    assert failed.cost.median == pytest.approx(0.5 * 0.50 + 1.0 * 0.14 + 0.2 * 0.10)
    run = failed.runs[0]
    assert math.isnan(replace(failed, runs=(replace(run, episodes=run.episodes[-1:]),)).cost.median)


def test_what_was_learned_is_counted_since_a_change_of_mind(tmp_path, simulate_results):
    distances = {0: [0.1, 0.1, 0.6, 0.14], 1: [0.1, 0.1, 0.6, 0.5]}

    def change(record):
        features = dict.fromkeys(record.features, 0.1 if record.episode < 2 else 0.5)
        return replace(record, distance_to_true=distances[record.seed][record.episode], features=features)

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=distances, change=change)
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"patient": {"earlier_episodes": 2}}}))
    (found,) = profile_results(load_results(tmp_path), "")
    assert found.convergence_episodes == (2, None)
    assert found.best_distance == spread([0.14, 0.5])
    assert found.cost.median == pytest.approx(0.5)
    assert found.episodes == 8


def test_before_a_change_of_mind_nothing_tells_how_well_the_new_wishes_are_known(figures):
    run = replace(figures.runs[1], earlier_episodes=4)
    early = replace(figures, runs=(run,))
    assert early.convergence_episodes == (None,)
    assert all(math.isnan(each.median) for each in (early.best_distance, early.final_distance, early.cost))


def test_nothing_is_said_of_a_patient_whose_wishes_are_unknown(tmp_path, simulate_results):
    simulate_results(tmp_path / "x", profiles=("speed_oriented",), seeds=(0,))
    path = tmp_path / "x" / "speed_oriented" / "seed_0" / "episodes.jsonl"
    path.write_text(path.read_text().replace('"profile": "speed_oriented"', '"profile": "custom"'))
    path.parents[1].rename(tmp_path / "x" / "custom")
    (found,) = profile_results(load_results(tmp_path / "x"), "")
    assert found.dominant_right is None
    assert math.isnan(found.cost.median)
