"""The picture of measured features."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mala_drake.preferences import CRITERIA
from mala_drake.reporting.figures import features as mut
from mala_drake.reporting.results import load_results


def test_only_episodes_in_which_the_task_was_done_are_drawn(tmp_path, simulate_results):
    def fail(record):
        if record.episode == 1:
            return replace(record, success=False, features=dict.fromkeys(record.features, 0.01))
        return replace(record, features=dict.fromkeys(record.features, 0.5 + 0.1 * record.episode))

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=3, change=fail)
    (picture,) = mut.feature_picture(load_results(tmp_path))
    assert len(picture.figure.axes) == len(CRITERIA)
    for axes in picture.figure.axes:
        ticks, _, median = (np.asarray(line.get_xdata(), dtype=float) for line in axes.lines)
        assert set(ticks[np.isfinite(ticks)]) == {0.5, 0.7}
        assert median[0] == pytest.approx(0.6)
