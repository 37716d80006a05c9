"""What a report says: the figures that matter, and everything that went wrong."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.reporting import findings as mut
from mala_drake.reporting.bound_results import final_error_over_bound
from mala_drake.reporting.results import load_results


def test_when_all_is_well_there_are_no_problems(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("comfort_focused",), episodes=6)
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"learner": {"name": "projected_gradient"}}}))
    results = load_results(tmp_path)
    assert mut.problems(results) == ()
    assert {figure.good for figure in mut.headline(results)} == {True, None}


@pytest.fixture
def gone_wrong(tmp_path, simulate_results):
    def spoil(record):
        if (record.seed, record.episode) == (1, 2):
            return replace(record, success=False, failure="blocked", collisions=3, distance_to_true=0.4)
        weights = [0.1, 0.6, 0.1, 0.1, 0.1] if record.seed == 0 else [0.6, 0.1, 0.1, 0.1, 0.1]
        return replace(record, distance_to_true=0.4, weights_after=weights)

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1), episodes=3, change=spoil)
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=2, condition="bandit", change=spoil)
    return load_results(tmp_path)


def test_everything_that_went_wrong_is_said_where(gone_wrong):
    assert mut.problems(gone_wrong) == (
        "1 of 6 episodes failed (1 × blocked): speed oriented seed 1, episode 3.",
        "3 collisions in 1 episode: speed oriented seed 1, episode 3.",
        "2 of 2 runs did not converge to d ≤ 0.15: speed oriented seed 0; speed oriented seed 1.",
        "In 1 of 2 runs the greatest weight is not what matters most to the patient.",
        "Under bandit: 1 of 1 run did not converge to d ≤ 0.15: speed oriented seed 0.",
        "Under bandit: In 1 of 1 run the greatest weight is not what matters most to the patient.",
        "There is no summary.json: the runs may not have come to their end.",
    )


def test_the_headline_marks_what_is_not_all(gone_wrong):
    assert [(figure.value, figure.good) for figure in mut.headline(gone_wrong)] == [
        ("5/6", False),
        ("3", False),
        ("0/2", False),
        ("never", None),
        ("0.400", None),
        ("1/2", False),
    ]


def test_many_failures_are_not_all_named(tmp_path, simulate_results):
    def fail(record):
        return replace(record, success=False, failure="blocked" if record.episode % 2 else "stuck")

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=range(3), episodes=4, change=fail)
    first = mut.problems(load_results(tmp_path))[0]
    assert first.startswith("12 of 12 episodes failed (6 × blocked; 6 × stuck): speed oriented seed 0, episode 1;")
    assert first.endswith("; and 4 more.")


def test_learning_is_told_beside_the_paper(gone_wrong):
    assert mut.learning_sentences(gone_wrong) == (
        "Main: no convergence and a final distance of 0.400 (medians by patient).",
        "The paper reports convergence after 2 rated episodes and final distances of 0.043.",
    )


def test_the_final_error_is_that_of_the_last_episodes_however_long_runs_are(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0, 1), episodes=6)
    patient = {"noise": 0.1}
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"patient": patient}}))
    path = tmp_path / "speed_oriented" / "seed_1" / "episodes.jsonl"
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:1]))
    results = load_results(tmp_path)
    known = [(run, PROFILES["speed_oriented"]) for run in results.runs]
    told = f"final error {final_error_over_bound(known, 0.1):.2f} times the information bound."
    assert mut.learning_sentences(results)[0].endswith(told)


def test_wishes_that_are_even_have_nothing_that_matters_most(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=6)
    patient = {"true_weights": [0.2] * 5}
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"patient": patient}}))
    path = tmp_path / "speed_oriented" / "seed_0" / "episodes.jsonl"
    path.write_text(path.read_text().replace('"profile": "speed_oriented"', '"profile": "custom"'))
    path.parents[1].rename(tmp_path / "custom")
    results = load_results(tmp_path)
    assert not any("greatest weight" in problem for problem in mut.problems(results))
    assert "runs know what matters most" not in {figure.meaning for figure in mut.headline(results)}


def test_the_most_frequent_plan_of_each_patient_is_told(tmp_path, simulate_results):
    def choose(record):
        return replace(record, plan_variant="north/A/med-supp/left" if record.episode else "south/B/supp-med/right")

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=4, change=choose)
    assert mut.plan_sentences(load_results(tmp_path)) == (
        "Speed oriented: medication mostly by north, A, medicine first, left (75 %).",
    )
