"""The stations that a run needs: one for each task, so that no episode pays for boxes of another task."""

from __future__ import annotations

from pydrake.geometry import Meshcat
from pydrake.systems.framework import Diagram

from mala_drake.scenario import Scenario
from mala_drake.scheduling.sequence import task_names
from mala_drake.station import MakeCareStation


class Stations:
    """Builds the stations of one scenario when they are first needed, and keeps them.

    What an episode comes to does not depend on which other boxes there are, nor on what its station has simulated
    before.
    """

    def __init__(self, scenario: Scenario, *, meshcat: Meshcat | None = None) -> None:
        """Builds nothing yet, but for a station that is to be seen.

        Args:
            scenario: to be simulated.
            meshcat: shows it, if given. There is then one station with the boxes of all tasks, which are to be seen.

        Raises:
            BadInput: naming the field of the scenario, or the place in a model, that is wrong.
        """
        self.scenario = scenario
        self._tasks = task_names(scenario.task, episodes=scenario.episodes)
        shown = {} if meshcat is None else dict.fromkeys(self._tasks, MakeCareStation(scenario, meshcat=meshcat))
        self._stations: dict[str, Diagram] = shown

    def of_episode(self, episode: int) -> Diagram:
        """The station that simulates the episode of this number, from 0.

        Raises:
            BadInput: as the constructor.
        """
        task = self._tasks[episode]
        if task not in self._stations:
            self._stations[task] = MakeCareStation(self.scenario, task=task)
        return self._stations[task]
