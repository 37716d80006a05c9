"""What holds before anything is learned."""

from __future__ import annotations

from mala_drake.messages import learned as mut


def test_preferences_begin_uniform():
    for weights in (mut.Preferences().planning, mut.Preferences().estimate):
        assert weights == (0.2,) * 5
