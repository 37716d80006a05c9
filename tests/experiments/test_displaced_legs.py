import math

import pytest

import mala_drake.experiments.displaced_legs as mut
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    LearnedTargets,
    Outcome,
    PlaceMismatch,
    SensitivitySource,
)
from mala_drake.scenario import DisplacedPlaceConfig, Scenario

MAPPED = (-3.0, 15.0)
BY = (-0.5, 1.9)


def go(place):
    return Action(1, ActionKind.MOVE, f"go_to_{place}", ("robot1",), place)


def report(outcome=Outcome.SUCCESS):
    return ActionReport(1, outcome, closed_loop_cost=12.5)


@pytest.fixture
def scenario():
    scenario = Scenario()
    scenario.world.displaced_places = [DisplacedPlaceConfig("pantry", *BY)]
    return scenario


def test_a_leg_to_a_displaced_place_is_kept_with_its_target(scenario):
    legs = mut.DisplacedLegs(scenario, LearnedTargets())
    legs.add(go("pantry"), report(), PlaceMismatch("pantry", 0.25), LearnedTargets())
    moved = (("pantry", MAPPED[0] + BY[0], MAPPED[1] + BY[1] + 0.3),)
    learned = LearnedTargets(moved, 1, SensitivitySource.FALLBACK, 0.7)
    legs.add(go("pantry"), report(Outcome.BLOCKED), PlaceMismatch("pantry", 0.5), learned)
    legs.add(go("pantry"), report(), PlaceMismatch("pantry", 0.0), learned)
    first, second, third = legs.entries
    assert first == {
        "place": "pantry",
        "outcome": "success",
        "mismatch": 0.25,
        "closed_loop_cost": 12.5,
        "moved": False,
        "x": MAPPED[0],
        "y": MAPPED[1],
        "distance_to_true_m": pytest.approx(math.hypot(*BY)),
        "sensitivity": None,
        "sensitivity_deviation": None,
    }
    assert (second["outcome"], second["mismatch"], second["moved"]) == ("blocked", 0.5, True)
    assert second["distance_to_true_m"] == pytest.approx(0.3)
    assert (second["sensitivity"], second["sensitivity_deviation"]) == ("fallback", 0.7)
    assert (third["mismatch"], third["moved"]) == (0.0, False)
    assert (third["sensitivity"], third["sensitivity_deviation"]) == (None, None)


def test_what_was_learned_in_earlier_episodes_is_no_move(scenario):
    learned = LearnedTargets((("pantry", 0.0, 0.0),), 3)
    legs = mut.DisplacedLegs(scenario, learned)
    legs.add(go("pantry"), report(), PlaceMismatch("pantry", 0.25), learned)
    assert not legs.entries[0]["moved"]


def test_legs_to_other_places_are_not_kept(scenario):
    legs = mut.DisplacedLegs(scenario, LearnedTargets())
    legs.add(go("stove"), report(), PlaceMismatch("stove", 0.0), LearnedTargets())
    legs.add(go("pantry"), report(), PlaceMismatch(), LearnedTargets())
    assert not legs.entries


def test_an_action_there_whose_things_are_out_of_reach_is_kept_as_well(scenario):
    legs = mut.DisplacedLegs(scenario, LearnedTargets())
    collect = Action(2, ActionKind.IN_PLACE, "collect_ingredient", ("robot1",), "pantry", "pantry")
    learned = LearnedTargets((("pantry", MAPPED[0], MAPPED[1] + 1.0),), 1)
    legs.add(collect, ActionReport(2, Outcome.OUT_OF_REACH), PlaceMismatch("pantry", 0.1), learned)
    ((outcome, mismatch, moved),) = [(each["outcome"], each["mismatch"], each["moved"]) for each in legs.entries]
    assert (outcome, mismatch, moved) == ("out_of_reach", 0.1, True)
