"""What holds before anything is learned."""

from __future__ import annotations

from mala_drake.messages import learned as mut


def test_preferences_begin_uniform():
    for weights in (mut.Preferences().planning, mut.Preferences().estimate):
        assert weights == (0.2,) * 5


def test_a_leg_ends_where_it_was_learned_to_and_else_where_the_map_says():
    mapped = (6.0, 0.0, 1.5)
    assert mut.LearnedTargets().pose("there", mapped) == mapped
    learned = mut.LearnedTargets((("elsewhere", 1.0, 2.0), ("there", 4.0, 2.0)), 1)
    assert learned.pose("there", mapped) == (4.0, 2.0, 1.5)
    assert learned.pose("nowhere", mapped) == mapped
