"""Experiments: which runs there are, and what each simulates."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import experiment as mut
from mala_drake.scenario import PatientConfig, Scenario


def experiment(**changes):
    values = {
        "name": "convergence",
        "base": Scenario(task="alternate", episodes=3, episode_time_limit=7.5),
        "conditions": {mut.MAIN: {}, "noisy": {"patient": {"noise": 0.4}, "task": "meal"}},
        "profiles": ("safety_first", "speed_oriented"),
        "seeds": (4, 0),
    }
    return mut.Experiment(**{**values, **changes})


def test_there_is_a_run_for_each_condition_seed_and_profile():
    runs = experiment().runs
    assert len(runs) == len(set(runs)) == 8
    assert runs[0] == mut.RunName("", "safety_first", 4)
    assert [run.condition for run in runs] == [""] * 4 + ["noisy"] * 4


def test_folders_are_the_agreed_ones():
    assert mut.RunName("", "safety_first", 4).folder == Path("safety_first/seed_4")
    assert mut.RunName("noisy", "safety_first", 4).folder == Path("noisy/safety_first/seed_4")


def test_a_run_simulates_the_base_with_its_patient_seed_and_changes():
    asked = experiment()
    scenario = asked.scenario(mut.RunName("noisy", "speed_oriented", 4))
    expected = Scenario(
        random_seed=4,
        task="meal",
        episodes=3,
        episode_time_limit=7.5,
        patient=PatientConfig(profile="speed_oriented", noise=0.4),
    )
    assert scenario == expected
    assert asked.base == experiment().base  # Which no run changes.
    assert asked.scenario(mut.RunName("", "safety_first", 0)).patient.noise == PatientConfig().noise


def test_a_patient_of_ones_own_keeps_the_weights_and_the_others_have_theirs():
    base = Scenario(patient=PatientConfig(true_weights=[0.3, 0.3, 0.2, 0.1, 0.1]))
    asked = experiment(base=base, profiles=(mut.CUSTOM, "safety_first"))
    asked.validate()
    assert asked.scenario(mut.RunName("", mut.CUSTOM, 0)).true_weights == (0.3, 0.3, 0.2, 0.1, 0.1)
    assert asked.scenario(mut.RunName("", "safety_first", 0)).profile_name == "safety_first"
    with pytest.raises(BadInput, match="true_weights"):
        experiment(profiles=(mut.CUSTOM,)).validate()


def test_json_gives_the_experiment_back():
    asked = experiment()
    told = json.loads(json.dumps(asked.to_json()))
    assert mut.Experiment.from_json(told, where="file") == asked


def test_what_is_no_experiment_is_refused():
    told = experiment().to_json()
    for key in ("experiment", "scenario", "conditions", "profiles", "seeds"):
        with pytest.raises(BadInput, match="file"):
            mut.Experiment.from_json({name: value for name, value in told.items() if name != key}, where="file")
    with pytest.raises(BadInput, match="file"):
        mut.Experiment.from_json([], where="file")
    with pytest.raises(BadInput, match=r"file: wheels: unknown key"):
        mut.Experiment.from_json({**told, "scenario": {"wheels": 3}}, where="file")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wheels": 3}, r"condition odd: wheels: unknown key"),
        ({"patient": {"noise": "loud"}}, r"condition odd: patient\.noise"),
        ({"patient": {"noise": -1.0}}, r"condition odd: patient\.noise: -1"),
    ],
)
def test_a_condition_that_is_no_scenario_is_refused_before_anything_runs(changes, words):
    with pytest.raises(BadInput, match=words):
        experiment(conditions={"odd": changes}).validate()


def test_a_mistake_in_the_base_is_told_by_its_field():
    base = dataclasses.replace(experiment().base, episodes=0)
    with pytest.raises(BadInput, match=r"^episodes: 0"):
        experiment(base=base).validate()
