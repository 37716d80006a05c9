"""A run's recording: one file with the ward's legend and the captions of the run."""

from __future__ import annotations

import json
import re

import pytest
from pydrake.geometry import Box, Meshcat
from pydrake.math import RigidTransform

from mala_drake.errors import BadInput
from mala_drake.reporting import run_recording as mut
from mala_drake.ward.ward_map import LoadWard


@pytest.fixture
def meshcat():
    viewer = Meshcat()
    viewer.SetObject("/drake/visualizer/care_robot/base", Box(0.4, 0.4, 0.4))
    return viewer


def data_of(page):
    found = re.search(r'<script type="application/json" id="recording">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_captions_and_places_are_in_the_file(meshcat, tmp_path):
    path = tmp_path / "recording.html"
    recording = mut.RunRecording(meshcat, path, LoadWard(), title="medication")
    for tick in range(3):
        meshcat.SetTransform("/drake/visualizer/care_robot/base", RigidTransform([0.2 * tick, 0, 0]), 0.2 * tick)
        recording.caption(0.2 * tick, f"Episode 1: step {tick} </script>")
    recording.finish()
    data = data_of(path.read_text(encoding="utf-8"))
    assert data["title"] == "medication"
    assert data["captions"] == [[0.2 * tick, f"Episode 1: step {tick} </script>"] for tick in range(3)]
    assert data["follow"] == "/drake/visualizer/care_robot/base"
    legend = " ".join(entry["text"] for entry in data["legend"])
    for place in LoadWard().places:
        assert place.name.replace("_", " ") in legend


def test_the_body_to_follow_is_the_robot_of_the_station():
    assert mut._ROBOT_IN_MESHCAT.endswith("/care_robot/base")


def test_a_file_that_cannot_be_written_is_named(meshcat, tmp_path):
    (tmp_path / "file").write_text("")
    recording = mut.RunRecording(meshcat, tmp_path / "file" / "recording.html", LoadWard(), title="medication")
    with pytest.raises(BadInput, match=r"recording\.html: cannot be written"):
        recording.finish()
