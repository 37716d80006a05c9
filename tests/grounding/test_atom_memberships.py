import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.grounding import FuzzyGrounding
from mala_drake.grounding import atom_memberships as mut
from mala_drake.grounding.predicates import Observation
from mala_drake.messages import Action, WorldFacts

LOW = ("battery-low", "robot1")


def battery_low(kind, charge):
    (membership,) = mut.predicate_memberships(kind).values()
    return membership.truths(Observation(None, charge, WorldFacts(), Action()))[LOW]


def test_fuzzy_memberships_have_degrees():
    np.testing.assert_allclose(mut.location_membership("fuzzy").value([0.5, 2.0, 3.0, 6.0]), [1.0, 0.75, 0.5, 0.0])
    assert battery_low("fuzzy", 0.2) == pytest.approx(0.5)


def test_crisp_memberships_are_true_or_false_where_the_fuzzy_ones_pass_the_threshold():
    np.testing.assert_array_equal(mut.location_membership("crisp").value([0.5, 2.1, 2.3, 6.0]), [1.0, 1.0, 0.0, 0.0])
    assert [battery_low("crisp", charge) for charge in (0.1, 0.175, 0.185, 0.3)] == [1.0, 1.0, 0.0, 0.0]


def test_the_grounding_is_fuzzy_unless_told_otherwise():
    told = FuzzyGrounding(
        locations={"home": (0.0, 0.0)},
        location_membership=mut.location_membership("fuzzy"),
        predicate_memberships=mut.predicate_memberships("fuzzy"),
    )
    untold = FuzzyGrounding(locations={"home": (0.0, 0.0)})
    for system in (told, untold):
        context = system.CreateDefaultContext()
        system.GetInputPort("robot_state").FixValue(context, [3.0, 0, 0, 0, 0, 0])
        system.GetInputPort("charge").FixValue(context, [0.18])
        system.GetInputPort("world_facts").FixValue(context, system.GetInputPort("world_facts").Allocate())
        system.GetInputPort("action").FixValue(context, system.GetInputPort("action").Allocate())
        memberships = system.GetOutputPort("memberships").Eval(context)
        assert memberships.value(("at", "robot1", "home")) == pytest.approx(0.5)
        assert memberships.value(LOW) == pytest.approx(0.7)


@pytest.mark.parametrize("make", [mut.location_membership, mut.predicate_memberships])
def test_other_kinds_are_refused(make):
    with pytest.raises(BadInput, match="'vague'; expected one of fuzzy, crisp"):
        make("vague")
