"""The conditions of the ablations: each is part of a scenario file, and changes what its name says and nothing else."""

from __future__ import annotations

from dataclasses import asdict

import pytest
import yaml

from mala_drake.experiments import ablations as mut
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.scenario import LearnerConfig, LoadScenario, Scenario, Validate
from mala_drake.station import MakeCareStation

BASE = Scenario(task="alternate", episodes=2)
CONDITIONS = mut.ablation_conditions(BASE, None)
EXPERIMENT = Experiment("ablations", BASE, CONDITIONS, profiles=("comfort_focused",), seeds=(1,))

CHANGED = {
    "full": {},
    "projected_gradient": {"learner.name": "projected_gradient"},
    "reference_gradient": {"learner.name": "reference_gradient"},
    "bandit": {"learner.name": "bandit"},
    "uniform_weights": {"learner.name": "fixed"},
    "random_weights": {"learner.name": "random"},
    "no_exploration": {"learner.exploration_until": 1.0},
    "no_exploration_decay": {"learner.name": "projected_gradient", "learner.exploration_decay": 0.0},
    "crisp_grounding": {"grounding.membership": "crisp"},
    "no_learned_costs": {"planner.learned_costs": False},
    "medication_only": {"task": "medication"},
    "meal_only": {"task": "meal"},
    "rating_noise_0.05": {"patient.noise": 0.05},
    "rating_noise_0.2": {"patient.noise": 0.2},
    "rating_noise_0.4": {"patient.noise": 0.4},
    "clipped_ratings": {"patient.clip": True},
    "missing_ratings": {"patient.missing": 0.3},
    "drifting_patient": {"patient.earlier_weights": [0.1, 0.1, 0.3, 0.1, 0.4], "patient.earlier_episodes": 10},
    "dirichlet_initial_weights": {"learner.name": "projected_gradient", "learner.random_initial_weights": True},
    "changing_risk": {"world.risk_variation": 0.15},
    "wrong_items_0": {"world.wrong_item_probability": 0.0},
    "wrong_items_0.3": {"world.wrong_item_probability": 0.3},
}
"""By hand: every field that differs from the base."""


def scenario(condition):
    return EXPERIMENT.scenario(RunName(condition, "comfort_focused", 1))


def flat(data, prefix=""):
    for name, value in data.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def test_these_are_the_conditions():
    assert list(CONDITIONS) == list(mut.ABLATION_KIND.condition_names) == list(CHANGED)
    assert set(mut.ABLATION_KIND.explanations) == set(CHANGED)


@pytest.mark.parametrize("condition", CHANGED)
def test_a_condition_changes_what_its_name_says_and_nothing_else(condition):
    before = dict(flat(asdict(scenario("full"))))
    after = dict(flat(asdict(scenario(condition))))
    assert {name: value for name, value in after.items() if value != before[name]} == CHANGED[condition]


@pytest.mark.parametrize("condition", CHANGED)
def test_anybody_can_run_a_condition_from_a_file(tmp_path, condition):
    own = {"random_seed": 1, "episodes": 2, "task": "alternate", "patient": {"profile": "comfort_focused"}}
    changes = CONDITIONS[condition]
    own = {**own, **changes, "patient": {**own["patient"], **changes.get("patient", {})}}
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(own))
    assert LoadScenario(tmp_path / "mine.yaml") == scenario(condition)


def test_all_of_them_can_be_simulated():
    for condition in CHANGED:
        Validate(scenario(condition))


def test_the_options_reach_the_systems():
    """The fields that exist for the ablations are read where it counts."""
    changed = Scenario(episodes=1)
    changed.grounding.membership = "crisp"
    changed.world.risk_variation = 0.15
    changed.patient.earlier_weights, changed.patient.earlier_episodes = [0.1, 0.1, 0.3, 0.1, 0.4], 10
    station = MakeCareStation(changed)
    context = station.CreateDefaultContext()
    grounding = station.GetSubsystemByName("fuzzy_grounding")
    robot_state = grounding.GetInputPort("robot_state")
    memberships = grounding.GetOutputPort("memberships").Eval(grounding.GetMyContextFromRoot(context))
    assert robot_state.HasValue(grounding.GetMyContextFromRoot(context))
    assert set(memberships.values) <= {0.0, 1.0}
    assert station.GetSubsystemByName("feature_meter")._risk_variation == 0.15
    assert station.GetSubsystemByName("patient")._earlier == (0.1, 0.1, 0.3, 0.1, 0.4)


OWN = {
    "posterior": {"exploration_until": 0.1},
    "projected_gradient": {"learning_rate": 0.05, "exploration": 0.3},
    "reference_gradient": {"learning_rate": 0.05, "exploration_decay": 0.0},
}


@pytest.mark.parametrize("learner", OWN)
def test_a_condition_is_what_it_says_whatever_the_file_says_of_its_own_learner(learner):
    base = Scenario(learner=LearnerConfig(name=learner, **OWN[learner]))
    Validate(base)
    experiment = Experiment("ablations", base, mut.ablation_conditions(base, None), ("comfort_focused",), (1,))
    experiment.validate()
    for condition, changes in experiment.conditions.items():
        changed = experiment.scenario(RunName(condition, "comfort_focused", 1))
        told, found = dict(flat(changes)), dict(flat(asdict(changed)))
        assert {name: found[name] for name in told} == told
        if changed.learner.name == learner:
            kept = {f"learner.{name}": value for name, value in OWN[learner].items()}
            assert {name: found[name] for name in kept} == {**kept, **{n: told[n] for n in kept if n in told}}


def test_conditions_come_in_the_order_of_the_table():
    assert list(mut.ablation_conditions(BASE, ("meal_only", "full"))) == ["full", "meal_only"]
