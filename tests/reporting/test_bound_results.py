"""Errors in units of the information bound, against Monte Carlo and by hand."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.reporting import bound_results as mut
from mala_drake.reporting.results import load_results

NOISE = 0.1
TRUE = np.array(PROFILES["speed_oriented"])


def write_summary(folder, patient):
    (folder / "summary.json").write_text(json.dumps({"scenario": {"patient": patient}}))


def least_squares(folder, simulate_results):
    """Runs whose weights are the constrained least squares estimate: the efficient one, which meets the bound."""
    seen = {}

    def estimate(record):
        history = seen.setdefault(record.seed, [])
        history.append((list(record.features.values()), record.ratings))
        features, ratings = (np.array(each, dtype=float) for each in zip(*history, strict=True))
        information, evidence = 16.0 * (features**2).sum(axis=0), (4.0 * features * (5.0 - ratings)).sum(axis=0)
        system = np.block([[np.diag(information), np.ones((5, 1))], [np.ones((1, 5)), np.zeros((1, 1))]])
        return replace(record, weights_after=list(np.linalg.solve(system, [*evidence, 1.0])[:5]))

    simulate_results(folder, profiles=("speed_oriented",), seeds=range(150), episodes=3, change=estimate)
    write_summary(folder, {"noise": NOISE})
    return load_results(folder)


def test_an_efficient_estimate_is_at_the_bound(tmp_path, simulate_results):
    ratios = mut.error_over_bound(least_squares(tmp_path, simulate_results), "")
    np.testing.assert_allclose(ratios, 1.0, atol=0.08)


def test_what_was_not_rated_tells_nothing(tmp_path, simulate_results):
    def silent(record):
        return replace(record, ratings=[None] * 5) if record.episode < 2 else record

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=4, change=silent)
    write_summary(tmp_path, {"noise": NOISE})
    results = load_results(tmp_path)
    bounds = mut.bounds_of(results.runs[0], NOISE)
    assert np.isinf(bounds[:2]).all()
    assert np.isfinite(bounds[2:]).all()
    assert np.all(bounds[3] < bounds[2])
    assert list(np.isfinite(mut.error_over_bound(results, ""))) == [False, False, True, True]


def test_ratings_by_earlier_wishes_tell_nothing_of_the_present_ones(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=4)
    write_summary(tmp_path, {"noise": NOISE})
    (run,) = load_results(tmp_path).runs
    write_summary(tmp_path, {"noise": NOISE, "earlier_episodes": 2})
    results = load_results(tmp_path)
    bounds = mut.bounds_of(results.runs[0], NOISE)
    assert np.isinf(bounds[:2]).all()
    np.testing.assert_allclose(bounds[2:], mut.bounds_of(replace(run, episodes=run.episodes[2:]), NOISE))
    assert list(np.isfinite(mut.error_over_bound(results, ""))) == [False, False, True, True]


def test_the_final_error_is_that_of_each_runs_own_last_episode(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1), episodes=3)
    write_summary(tmp_path, {"noise": NOISE})
    long, short = load_results(tmp_path).runs
    short = replace(short, episodes=short.episodes[:1])
    ratios = [mut.errors_of(run, TRUE)[-1] / mut.bounds_of(run, NOISE)[-1] for run in (long, short)]
    found = mut.final_error_over_bound([(long, TRUE), (short, TRUE)], NOISE)
    assert found == pytest.approx(np.sqrt(np.mean(np.square(ratios))))


def test_there_is_no_final_error_over_bound_where_a_run_has_no_bound(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1), episodes=2)
    run, other = load_results(tmp_path).runs
    assert mut.final_error_over_bound([(run, TRUE), (other, TRUE)], NOISE) is not None
    early = replace(other, earlier_episodes=2)
    assert mut.final_error_over_bound([(run, TRUE), (early, TRUE)], NOISE) is None
    assert mut.final_error_over_bound([(run, TRUE)], None) is None
    assert mut.final_error_over_bound([], NOISE) is None


def test_errors_are_learned_minus_true(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=2)
    (run,) = load_results(tmp_path).runs
    np.testing.assert_allclose(mut.errors_of(run, TRUE)[1] + TRUE, run.final.weights_after)


@pytest.mark.parametrize(
    ("patient", "noise"),
    [
        ({"noise": 0.2}, 0.2),
        ({"noise": 1}, 1.0),
        ({"noise": 0.0}, None),
        ({"noise": None}, None),
        ({}, None),
        (3, None),
    ],
)
def test_the_noise_is_what_the_folder_tells(tmp_path, simulate_results, patient, noise):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    write_summary(tmp_path, patient)
    assert mut.rating_noise(load_results(tmp_path), "") == noise
