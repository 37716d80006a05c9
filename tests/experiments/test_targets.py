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
    ("condition", "evidence", "dynamics"),
    [("full", "geometric", True), ("geometric", "geometric", False), ("fuzzy", "fuzzy", False)],
)
def test_the_papers_places_are_displaced_and_their_targets_learned(condition, evidence, dynamics):
    chosen = scenario(condition)
    assert tuple(chosen.displacements(chosen.load_ward())) == mut.DISPLACED
    control = chosen.control
    assert (control.learned_targets, control.target_evidence, control.learned_dynamics) == (True, evidence, dynamics)


def test_the_identity_is_the_full_system_but_for_the_sensitivity():
    full, identity = scenario("full", seed=3), scenario("identity", seed=3)
    assert full.control.target_sensitivity == Scenario().control.target_sensitivity == "simulated"
    assert identity.control.target_sensitivity == "identity"
    identity.control.target_sensitivity = "simulated"
    assert identity == full


def test_the_outer_loop_alone_learns_what_the_patient_wants_in_the_same_ward():
    learning, fixed = scenario("full", seed=3), scenario("outer_loop_only", seed=3)
    assert not fixed.control.learned_targets
    assert not fixed.control.learned_dynamics
    assert fixed.learner == learning.learner
    ward = fixed.load_ward()
    assert fixed.displacements(ward) == learning.displacements(ward)


def test_a_scenario_may_say_itself_what_is_displaced():
    base = Scenario()
    base.world.displaced_places = [DisplacedPlaceConfig("stove", 0.0, -2.5)]
    chosen = scenario("fuzzy", base)
    assert chosen.displacements(chosen.load_ward()) == {"stove": (0.0, -2.5)}


def test_what_the_file_says_of_a_learner_that_a_condition_leaves_out_goes_with_it():
    base = Scenario()
    base.control.learned_targets, base.control.target_evidence = True, "geometric"
    assert scenario("geometric", base).control.target_evidence == "geometric"
    assert scenario("outer_loop_only", base).control == Scenario().control


def test_conditions_come_in_the_order_of_the_table():
    assert list(mut.target_conditions(Scenario(), ("outer_loop_only", "full"))) == ["full", "outer_loop_only"]
