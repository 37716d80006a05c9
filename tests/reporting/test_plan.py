"""What was to be run, and what of it is missing."""

from __future__ import annotations

import json

import pytest

from mala_drake.experiments.experiment import Experiment
from mala_drake.reporting.results import load_results
from mala_drake.scenario import Scenario

LEARNERS = {
    "": {"learner": {"name": "posterior"}},
    "gradient": {"learner": {"name": "projected_gradient"}, "patient": {"noise": 0.3}},
}


@pytest.fixture
def begin():
    """Writes what an experiment of two profiles, two seeds and three episodes is begun with."""

    def write(folder, conditions=LEARNERS, profiles=("speed_oriented", "safety_first"), **patient):
        base = Scenario(episodes=3)
        for name, value in patient.items():
            setattr(base.patient, name, value)
        experiment = Experiment("convergence", base, conditions, profiles, (0, 1))
        (folder / "experiment.json").write_text(json.dumps(experiment.to_json()))

    return write


def test_an_experiment_that_is_all_there_misses_nothing(tmp_path, simulate_results, begin):
    begin(tmp_path)
    for condition in LEARNERS:
        simulate_results(tmp_path, profiles=("speed_oriented", "safety_first"), episodes=3, condition=condition)
    (tmp_path / "summary.json").write_text("{}")
    results = load_results(tmp_path)
    assert results.notes == ()
    assert [results.learner(condition) for condition in results.conditions] == ["posterior", "gradient"]
    assert [results.told(condition, "patient", "noise") for condition in results.conditions] == [0.1, 0.3]


def test_what_is_missing_is_judged_by_the_plan(tmp_path, simulate_results, begin):
    begin(tmp_path)
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(1,), episodes=2)
    assert load_results(tmp_path).notes == (
        "7 of 8 runs have no episode yet: speed oriented, seed 0; safety first, seed 0; safety first, seed 1; "
        "gradient, speed oriented, seed 0; gradient, safety first, seed 0; gradient, speed oriented, seed 1; "
        "and 1 more.",
        "1 of 8 runs are not finished: speed oriented, seed 1.",
        "There is no summary.json: the runs may not have come to their end.",
    )


def test_the_plan_says_which_condition_is_the_main_one(tmp_path, simulate_results, begin):
    begin(tmp_path, conditions={"posterior": {}, "bandit": {}, "a_last_one": {}})
    for condition in ("a_last_one", "bandit", "posterior"):
        simulate_results(tmp_path, profiles=("speed_oriented",), episodes=3, condition=condition)
    assert load_results(tmp_path).conditions == ("posterior", "bandit", "a_last_one")


def test_a_patient_of_one_s_own_has_the_weights_of_the_plan(tmp_path, simulate_results, begin):
    weights = [0.3, 0.3, 0.2, 0.1, 0.1]
    begin(tmp_path, profiles=("custom", "speed_oriented"), true_weights=weights)
    simulate_results(tmp_path, profiles=("speed_oriented",), episodes=3)
    results = load_results(tmp_path)
    assert results.true_weights("custom") == tuple(weights)
    assert results.true_weights("speed_oriented") == (0.50, 0.12, 0.14, 0.14, 0.10)


@pytest.mark.parametrize("text", ["{torn", "[]", "{}", '{"experiment": "x", "scenario": {"new": 1}, "conditions": {}}'])
def test_a_plan_that_cannot_be_read_stops_nothing(tmp_path, simulate_results, text):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,))
    (tmp_path / "experiment.json").write_text(text)
    notes = load_results(tmp_path).notes
    assert any("experiment.json is of no use" in note for note in notes)


def test_a_plan_with_conditions_of_another_version_stops_nothing(tmp_path, simulate_results, begin):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,))
    begin(tmp_path, conditions={"": {"unheard_of": 3}})
    assert any("is of no use" in note for note in load_results(tmp_path).notes)
