"""A run of the station as a recording that explains itself."""

from __future__ import annotations

from pathlib import Path

from pydrake.geometry import Meshcat

from mala_drake.reporting.recording import FinishRecording, StartRecording, ward_legend
from mala_drake.reporting.scenery import SetScenery, bird_eye_view
from mala_drake.ward.ward_map import Ward

_ROBOT_IN_MESHCAT = "/drake/visualizer/care_robot/base"


class RunRecording:
    """Records from its making on, collects captions, and writes the file when finished."""

    def __init__(self, meshcat: Meshcat, path: Path, ward: Ward, *, title: str) -> None:
        """Starts to record what the visualizer on `meshcat` publishes."""
        self._meshcat = meshcat
        self._path = path
        self._ward = ward
        self._title = title
        self._captions: list[tuple[float, str]] = []
        SetScenery(meshcat, bird_eye_view(ward))
        StartRecording(meshcat)

    def caption(self, time: float, text: str) -> None:
        """What is going on from `time` (seconds of simulation) on."""
        self._captions.append((time, text))

    def finish(self) -> None:
        """Writes the recording.

        Raises:
            BadInput: when the file cannot be written.
        """
        FinishRecording(
            self._meshcat,
            self._path,
            title=self._title,
            view=bird_eye_view(self._ward),
            legend=ward_legend(self._ward),
            captions=self._captions,
            follow=_ROBOT_IN_MESHCAT,
        )
