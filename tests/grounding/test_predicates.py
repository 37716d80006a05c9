import pytest

from mala_drake.grounding import ChargeMembership, LocationMembership, Observation, ProximityMembership, Sigmoid
from mala_drake.grounding.predicates import world_fact_truths
from mala_drake.messages import Action, RobotState, WorldFacts

LOW = ("battery-low", "robot1")
NEAR = ("near", "robot1", "patient1")


def observation(robot_state=None, charge=1.0, facts=()):
    return Observation(robot_state, charge, WorldFacts(tuple(facts)), Action())


@pytest.mark.parametrize(("charge", "truth"), [(0.0, 1.0), (0.15, 1.0), (0.2, 0.5), (0.25, 0.0), (1.0, 0.0)])
def test_a_low_battery_is_gradual_between_the_two_penalty_levels(charge, truth):
    assert ChargeMembership(LOW).truths(observation(charge=charge)) == {LOW: pytest.approx(truth)}


def test_any_membership_of_the_charge_can_be_put_in():
    membership = ChargeMembership(LOW, Sigmoid(0.2, -40.0))
    assert membership.truths(observation(charge=0.2)) == {LOW: 0.5}


def test_proximity_is_grounded_in_the_position():
    near = ProximityMembership(((NEAR, LocationMembership((22.0, 10.0))),))
    assert near.truths(observation(RobotState(x=22.0, y=13.0))) == {NEAR: pytest.approx(0.5)}


def test_proximity_says_nothing_when_the_position_is_unknown():
    near = ProximityMembership(((NEAR, LocationMembership((22.0, 10.0))),))
    assert near.truths(observation(None)) == {}


def test_facts_are_certain_unless_their_predicate_has_a_function_of_its_own():
    facts = WorldFacts((("has-supplement", "robot1"), ("has-medication", "robot1"), LOW))
    truths = world_fact_truths(facts, except_predicates=frozenset({"battery-low"}))
    assert list(truths.items()) == [(("has-medication", "robot1"), 1.0), (("has-supplement", "robot1"), 1.0)]
