"""Where the time of an episode goes: all of it is somewhere."""

from __future__ import annotations

import pytest

from mala_drake.experiments import bench_episode as mut


def test_the_parts_are_the_whole_and_every_layer_has_its_own():
    rows = mut.bench_episode(tasks=("medication",), time_limit=3.0)
    undisturbed, whole, *parts = rows
    assert [row["part"] for row in (undisturbed, whole)] == ["whole episode, without the profiler", "whole episode"]
    assert {row["part"] for row in parts} == {*mut._PARTS.values(), mut._OTHER, mut._COMPILED}
    assert sum(row["cpu_s"] for row in parts) == pytest.approx(whole["cpu_s"])
    assert sum(row["share"] for row in parts) == pytest.approx(1.0)
    assert all(row["cpu_s"] > 0.0 for row in rows)
    assert whole["ms_per_simulated_s"] == pytest.approx(1e3 * whole["cpu_s"] / 3.0)
    assert len({tuple(row) for row in rows}) == 1
