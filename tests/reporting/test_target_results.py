"""Displaced targets run by run, from results whose legs are known."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from mala_drake.reporting import target_results as mut
from mala_drake.reporting.results import load_results
from mala_drake.ward.ward_map import LoadWard

BED, PANTRY = "patient_bed_left", "pantry"
LEARNED = [
    [(BED, (0.9, 0.0), 0.25, True)],
    [(PANTRY, (0.0, -1.2), 0.3, True), (PANTRY, (0.1, 0.0), 0.05, True), (PANTRY, (0.1, 0.0), 0.0, False)],
    [(BED, (0.9, 0.0), 0.0, False)],
    [(PANTRY, (0.1, 0.0), 0.0, False), (BED, (0.05, 0.0), 0.0, True)],
]
MAPPED = [[(BED, (1.06, -1.06), 0.2, False)], [(PANTRY, (0.5, -1.9), 0.3, False)]]


def fail(record):
    record.success, record.failure = record.episode != 1, "" if record.episode != 1 else "out of reach"
    return record


@pytest.fixture(scope="module")
def folder(tmp_path_factory, simulate_targets):
    return simulate_targets(
        tmp_path_factory.mktemp("targets"), {"full": LEARNED, "outer_loop_only": MAPPED}, seeds=(3,), change=fail
    )


@pytest.fixture(scope="module")
def runs(folder):
    results, ward = load_results(folder), LoadWard()
    return {name: mut.target_runs(results, ward, name) for name in results.conditions}


def test_each_place_has_its_targets_from_the_map_on(runs):
    pantry, bed = runs["full"]  # In the order of the paper's.
    assert (pantry.place, bed.place) == (PANTRY, BED)
    assert pantry.mapped == (-3.0, 15.0)
    assert pantry.true == (-3.5, 16.9)
    assert pantry.distances == pytest.approx((math.hypot(0.5, 1.9), 1.2, 0.1))
    assert bed.distances == pytest.approx((math.hypot(1.06, 1.06), 0.9, 0.05))
    assert mut.places_of(runs["full"]) == (PANTRY, BED)


def test_a_mismatch_is_gone_once_it_does_not_come_back(runs):
    assert [run.updates_until_gone for run in runs["full"]] == [2, 1]
    assert [run.updates_until_gone for run in runs["outer_loop_only"]] == [None, None]


def test_deliveries_are_told_apart_by_when_the_mismatch_went(runs):
    pantry, bed = runs["full"]
    assert pantry.deliveries() == ((0, 1), (1, 1))
    assert bed.deliveries() == ((1, 1), (2, 2))
    assert [run.deliveries() for run in runs["outer_loop_only"]] == [((0, 1), (0, 0)), ((1, 1), (0, 0))]


@pytest.mark.parametrize("episodes", [1, 2, 3])
def test_after_a_mismatch_that_never_went_there_is_nothing(runs, episodes):
    pantry = runs["full"][0]
    seen, blocked = pantry.entries[0], {**pantry.entries[0], "outcome": "blocked", "mismatch": 0.0}
    record = pantry.run.episodes[0]
    records = [replace(record, displaced_legs=[leg]) for leg in (seen, blocked, blocked)[-episodes:]]
    run = replace(pantry, run=replace(pantry.run, episodes=tuple(records)))
    assert run.updates_until_gone is None
    assert run.deliveries() == ((episodes, episodes), (0, 0))


def test_the_displacement_is_that_of_the_runs_own_seed(tmp_path, folder):
    plan = json.loads((folder / "experiment.json").read_text())
    plan["scenario"]["world"] |= {"displaced_places": [], "randomly_displaced": [PANTRY, BED]}
    for path in folder.rglob("episodes.jsonl"):
        copy = tmp_path / path.relative_to(folder)
        copy.parent.mkdir(parents=True)
        copy.write_bytes(path.read_bytes())
    (tmp_path / "experiment.json").write_text(json.dumps(plan))
    run = mut.target_runs(load_results(tmp_path), LoadWard(), "full")[0]
    assert 1.5 <= run.distances[0] <= 4.0
    # Not the seed that the scenario itself has.
    told = mut._true_ward(load_results(tmp_path), run.run, LoadWard())
    assert (told.place[PANTRY].x, told.place[PANTRY].y) == run.true


def test_without_a_scenario_nobody_knows_where_places_are(tmp_path, folder):
    copy = tmp_path / "episodes.jsonl"
    copy.write_bytes(next(folder.rglob("episodes.jsonl")).read_bytes())
    results = load_results(tmp_path)
    assert mut.has_targets(results)
    assert mut.target_runs(results, LoadWard(), results.main) == ()


def test_results_without_displaced_places_have_no_targets(tmp_path, simulate_results):
    results = load_results(simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1))
    assert not mut.has_targets(results)
    assert mut.target_runs(results, LoadWard(), results.main) == ()
