"""The paper's own figures (Sec. "Simulation Results", with Table "Full-system convergence results")."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class PaperResults:
    """One row of the paper's table. It ran 5 seeds a profile; every run converged and every episode was delivered.

    Attributes:
        convergence: median and quartiles of the convergence episode, counted from 0 as in the paper.
        best_distance: mean and standard deviation of the least distance.
        final_distance: mean.
        variants: plan variants by the table, and by the paper's text, which counts otherwise.
    """

    convergence: tuple[int, int, int]
    best_distance: tuple[float, float]
    final_distance: float
    variants: tuple[int, int]

    @property
    def rated_episodes(self) -> tuple[int, int, int]:
        """Median and quartiles of the number of rated episodes to convergence: the paper's count plus one."""
        median, lower, upper = self.convergence
        return median + 1, lower + 1, upper + 1


RUNS = 5
"""Of each profile in the paper."""

PAPER_RESULTS: Mapping[str, PaperResults] = MappingProxyType(
    {
        "speed_oriented": PaperResults((1, 1, 1), (0.023, 0.008), 0.043, (3, 4)),
        "safety_first": PaperResults((9, 9, 17), (0.118, 0.018), 0.120, (3, 4)),
        "energy_conscious": PaperResults((29, 21, 30), (0.136, 0.008), 0.136, (3, 5)),
        "comfort_focused": PaperResults((0, 0, 1), (0.037, 0.006), 0.046, (1, 3)),
        "presentation_focused": PaperResults((16, 16, 17), (0.084, 0.006), 0.093, (2, 3)),
    }
)
"""By profile."""

PAPER_TARGET_UPDATES: Mapping[str, tuple[int, int]] = MappingProxyType(
    {"pantry": (13, 14), "patient_bed_left": (13, 14), "prep_station": (20, 20), "quality_check": (20, 20)}
)
"""By displaced place, after how many updates, at least and at most, its target came to rest in the paper.

From Sec. "Learning Continuous Target Parameters from Symbolic-Control Mismatches"; of the last two it says "closer to
20". The paper measures the distance to the target's own last value, not to the true
place, of which it says nothing.
"""
