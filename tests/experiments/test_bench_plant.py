"""The plant's benchmark: that it measures what it says, not how long it takes."""

from __future__ import annotations

import numpy as np
import pytest

from mala_drake.experiments import bench_plant as mut


def test_there_is_a_row_with_and_without_each_system():
    rows = mut.bench_plant(seconds=0.05, repetitions=1)
    names = [row["configuration"] for row in rows]
    assert names[:2] == ["robot alone", "all systems"]
    assert {f"all but {system}" for system in mut.SYSTEMS} <= set(names)
    for row in rows:
        assert row["wall_ms_per_s"] > 0.0
        assert row["processor_ms_per_s"] > 0.0


@pytest.mark.parametrize("left_out", mut.SYSTEMS)
def test_a_system_left_out_is_not_in_the_diagram(left_out):
    rig = mut._Rig([name for name in mut.SYSTEMS if name != left_out])
    there = {type(system).__name__.lower() for system in rig.diagram.GetSystems()}
    assert left_out.replace("_", "") not in there


def test_the_robot_drives_its_curve_with_boxes_at_both_pads():
    rig = mut._Rig(mut.SYSTEMS, carried=2)
    simulator = rig.start()
    simulator.AdvanceTo(2.0)
    plant = rig.diagram.GetSubsystemByName("plant")
    context = plant.GetMyContextFromRoot(simulator.get_context())
    base = plant.GetBodyByName("base")
    assert np.linalg.norm(plant.EvalBodyPoseInWorld(context, base).translation()) > 2.0
    for body in rig._carried:
        p_BI = plant.CalcRelativeTransform(context, base.body_frame(), body.body_frame()).translation()
        assert p_BI == pytest.approx([0.17, np.sign(p_BI[1]) * 0.07, 0.88], abs=0.01)
