"""What is told of an atom that nobody knows."""

from __future__ import annotations

from mala_drake.messages import observations as mut


def test_an_atom_that_is_not_grounded_has_membership_zero():
    memberships = mut.Memberships((("at", "robot1", "home"),), (0.7,))
    assert memberships.value(("at", "robot1", "home")) == 0.7
    assert memberships.value(("at", "robot1", "stove")) == 0.0
