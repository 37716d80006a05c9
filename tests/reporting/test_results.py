"""Reading results: every layout, what is missing is said, what is wrong is one line."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from mala_drake.errors import BadInput
from mala_drake.reporting import results as mut

EPISODES = "speed_oriented/seed_0/episodes.jsonl"


def refusal(folder):
    with pytest.raises(BadInput) as refused:
        mut.load_results(folder)
    text = str(refused.value)
    assert "\n" not in text
    return text


def test_an_experiment_is_read_run_by_run(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("safety_first", "speed_oriented"), seeds=(3, 1), episodes=2)
    results = mut.load_results(tmp_path)
    assert [(run.condition, run.profile, run.seed, len(run.episodes)) for run in results.runs] == [
        ("", "speed_oriented", 1, 2),
        ("", "speed_oriented", 3, 2),
        ("", "safety_first", 1, 2),
        ("", "safety_first", 3, 2),
    ]
    assert results.profiles == ("speed_oriented", "safety_first")
    assert results.tasks == ("medication",)


def test_a_record_is_read_as_it_was_written(tmp_path, simulate_results):
    """Nine decimals survive; what was not finite, and so null, is NaN again."""

    def spoil(record):
        return replace(
            record, min_clearance_m=math.inf, ratings=[None, *record.ratings[1:]], success=False, failure="x"
        )

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1, change=spoil)
    line = json.loads((tmp_path / EPISODES).read_text())
    record = mut.load_results(tmp_path).runs[0].final
    assert record.weights_after == line["weights_after"]
    assert record.features == line["features"]
    assert record.ratings[0] is None
    assert math.isnan(record.min_clearance_m)
    assert (record.success, record.failure) == (False, "x")
    assert record.weights_std is None


@pytest.mark.parametrize(
    ("patient", "earlier"), [({"earlier_episodes": 3}, 3), ({"earlier_episodes": "3"}, 0), ({}, 0), (3, 0)]
)
def test_a_run_knows_how_long_ago_the_patient_changed_its_mind(tmp_path, simulate_results, patient, earlier):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,))
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"patient": patient}}))
    assert mut.load_results(tmp_path).runs[0].earlier_episodes == earlier


def test_conditions_lie_beside_the_main_runs(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",))
    simulate_results(tmp_path, profiles=("speed_oriented",), condition="bandit")
    results = mut.load_results(tmp_path)
    assert results.conditions == ("", "bandit")
    assert len(results.of("bandit", "speed_oriented")) == 2
    assert results.of("bandit", "safety_first") == ()


def test_without_main_runs_the_full_condition_is_the_main_one(tmp_path, simulate_results):
    for condition in ("bandit", "full", "no_decay"):
        simulate_results(tmp_path, profiles=("speed_oriented",), condition=condition)
    assert mut.load_results(tmp_path).conditions == ("full", "bandit", "no_decay")


def test_a_plain_run_is_an_experiment_of_one(tmp_path, simulate_results):
    simulate_results(tmp_path / "e", profiles=("comfort_focused",), seeds=(7,))
    results = mut.load_results(tmp_path / "e" / "comfort_focused" / "seed_7")
    assert [(run.condition, run.profile, run.seed) for run in results.runs] == [("", "comfort_focused", 7)]


def test_the_summary_tells_learner_and_patient(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",))
    weights = [0.3, 0.3, 0.2, 0.1, 0.1]
    scenario = {"learner": {"name": "posterior"}, "patient": {"true_weights": weights}}
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": scenario}))
    results = mut.load_results(tmp_path)
    assert results.learner("") == "posterior"
    assert results.true_weights("custom") == tuple(weights)
    assert results.true_weights("speed_oriented") == (0.50, 0.12, 0.14, 0.14, 0.10)
    assert results.notes == ()


@pytest.mark.parametrize("summary", ["{torn", "[]", '{"scenario": 3}', '{"scenario": {"learner": 3, "patient": 3}}'])
def test_a_summary_that_tells_nothing_stops_nothing(tmp_path, simulate_results, summary):
    simulate_results(tmp_path, profiles=("speed_oriented",))
    (tmp_path / "summary.json").write_text(summary)
    results = mut.load_results(tmp_path)
    assert results.learner("") == "main"
    assert results.true_weights("custom") is None


def test_without_a_summary_that_of_a_run_tells_what_was_run(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1))
    scenario = {"learner": {"name": "bandit"}}
    (tmp_path / "speed_oriented" / "seed_1" / "summary.json").write_text(json.dumps({"scenario": scenario}))
    results = mut.load_results(tmp_path)
    assert results.learner("") == "bandit"
    assert any("no summary.json" in note for note in results.notes)


def test_a_torn_last_line_is_left_out_and_told(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=3)
    path = tmp_path / EPISODES
    path.write_text(path.read_text()[:-40])
    results = mut.load_results(tmp_path)
    assert len(results.runs[0].episodes) == 2
    assert any("torn" in note and EPISODES in note for note in results.notes)


def test_what_is_missing_is_told(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1), episodes=3)
    simulate_results(tmp_path, profiles=("safety_first",), seeds=(1,), episodes=2)
    (tmp_path / "safety_first" / "seed_0").mkdir(parents=True)
    (tmp_path / "safety_first" / "seed_0" / "episodes.jsonl").touch()
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd" / "episodes.jsonl").write_text((tmp_path / EPISODES).read_text())
    notes = "\n".join(mut.load_results(tmp_path).notes)
    assert "odd/episodes.jsonl is left out" in notes
    assert "No run of safety first with seed 0" in notes
    assert "safety first, seed 1, has only 2 of 3 episodes" in notes
    assert "no summary.json" in notes


def test_nothing_at_all_is_one_line(tmp_path):
    assert "has no episodes" in refusal(tmp_path)
    assert "is not a folder" in refusal(tmp_path / "nowhere")
    (tmp_path / "episodes.jsonl").write_text('{"torn')
    assert "has no episodes" in refusal(tmp_path)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda lines: [lines[0], "not json", lines[1]], "line 2: is not JSON"),
        (lambda lines: ["[1]", *lines], "line 1: is not an object"),
        (lambda lines: [lines[0], lines[0]], "line 2: episode 0; expected episode 1"),
        (lambda lines: [lines[1]], "line 1: episode 1; expected episode 0"),
        (lambda lines: [lines[0].replace('"seed": 0', '"seed": 5')], "seed 5; expected speed_oriented, seed 0"),
        (lambda lines: [lines[0].replace('"features": {', '"other": {')], "line 1: has no 'features'"),
        (lambda lines: [lines[0].replace('"success": true', '"success": 1')], "line 1: success: 1"),
        (lambda lines: [lines[0].replace('"collisions": 0', '"collisions": null')], "line 1: collisions: null"),
        (lambda lines: [lines[0].replace('"features": {', '"features": null, "x": {')], "line 1: features: null"),
    ],
)
def test_a_line_that_is_no_episode_is_named(tmp_path, simulate_results, change, told):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=2)
    path = tmp_path / EPISODES
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    assert told in refusal(tmp_path)


def test_keys_of_a_newer_version_are_passed_over(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    path = tmp_path / EPISODES
    path.write_text(path.read_text().replace('{"episode"', '{"something_new": [1], "episode"'))
    assert len(mut.load_results(tmp_path).runs) == 1
