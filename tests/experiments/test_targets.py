"""The experiment on targets: what its conditions change, and a leg of it as the file has it."""

from __future__ import annotations

import pytest

import mala_drake.experiments.targets as mut
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.experiments.experiments import experiment_kind
from mala_drake.scenario import DisplacedPlaceConfig, Scenario


def scenario(condition, base=None, seed=0):
    base = base or Scenario()
    experiment = Experiment("targets", base, mut.target_conditions(base, None), ("comfort_focused",), (seed,))
    experiment.validate()
    return experiment.scenario(RunName(condition, "comfort_focused", seed))


def test_it_can_be_asked_for_by_name():
    assert experiment_kind("targets") is mut.TARGETS
    assert set(mut.TARGETS.explanations) == set(mut.TARGETS.condition_names)


@pytest.mark.parametrize(
    ("condition", "learned", "evidence"), [("geometric", True, "geometric"), ("fuzzy", True, "fuzzy")]
)
def test_the_papers_places_are_displaced_and_their_targets_learned(condition, learned, evidence):
    chosen = scenario(condition)
    assert tuple(chosen.displacements(chosen.load_ward())) == mut.DISPLACED
    assert (chosen.control.learned_targets, chosen.control.target_evidence) == (learned, evidence)


def test_one_condition_learns_nothing_in_the_same_ward():
    learning, fixed = scenario("geometric", seed=3), scenario("map", seed=3)
    assert not fixed.control.learned_targets
    ward = fixed.load_ward()
    assert fixed.displacements(ward) == learning.displacements(ward)


def test_a_scenario_may_say_itself_what_is_displaced():
    base = Scenario()
    base.world.displaced_places = [DisplacedPlaceConfig("stove", 0.0, -2.5)]
    chosen = scenario("fuzzy", base)
    assert chosen.displacements(chosen.load_ward()) == {"stove": (0.0, -2.5)}


def test_conditions_come_in_the_order_of_the_table():
    assert list(mut.target_conditions(Scenario(), ("map", "geometric"))) == ["geometric", "map"]
