"""What became of displaced targets: figures by place over the runs of one condition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from mala_drake.experiments.episode_record import EpisodeRecord


def target_figures(runs: Sequence[Sequence[EpisodeRecord]]) -> dict[str, dict[str, Any]]:
    """By displaced place: how it was found, over the runs that have driven to it.

    `runs` is how many have; `found` how many of them came to be without mismatch for good; `updates` how often the
    target had been moved until then, and `final_distance_m` how far from the true place it was at the end, medians and
    maxima. `sensitivities` counts all updates by what they went through (see `SensitivitySource`), and
    `..._sensitivity_deviation` are |S - I|_2 of the sensitivities that were simulated for them, used or not.
    """
    legs = [[leg for record in records for leg in record.displaced_legs] for records in runs]
    places = sorted({leg["place"] for run in legs for leg in run})
    figures = {}
    for place in places:
        of_place = [[leg for leg in run if leg["place"] == place] for run in legs]
        driven = [run for run in of_place if run]
        updates = [count for run in driven if (count := updates_until_gone(run)) is not None]
        moves = [leg for run in driven for leg in run if leg["moved"]]
        sources = Counter(str(leg["sensitivity"]) for leg in moves if leg.get("sensitivity"))
        deviations = deviations_of(moves)
        finals = [run[-1]["distance_to_true_m"] for run in driven]
        figures[place] = {
            "runs": len(driven),
            "found": len(updates),
            "median_updates": float(np.median(updates)) if updates else None,
            "max_updates": max(updates, default=None),
            "median_final_distance_m": float(np.median(finals)),
            "max_final_distance_m": max(finals),
            "sensitivities": dict(sorted(sources.items())),
            "median_sensitivity_deviation": float(np.median(deviations)) if deviations else None,
            "max_sensitivity_deviation": max(deviations, default=None),
        }
    return figures


def deviations_of(legs: Sequence[dict[str, Any]]) -> list[float]:
    """|S - I|_2 of each sensitivity that was simulated for an update; of legs that earlier versions wrote, none."""
    return [float(leg["sensitivity_deviation"]) for leg in legs if leg.get("sensitivity_deviation") is not None]


def updates_until_gone(legs: Sequence[dict[str, Any]]) -> int | None:
    """How often the target had been moved when the mismatch was gone for good; None if it is there at the end.

    It is gone for good before the first of the last legs that all stopped at their target without mismatch, with
    everything there within reach.
    """
    first = len(legs)
    while first and not is_mismatch(legs[first - 1]):
        first -= 1
    reached = any(leg["outcome"] == "success" for leg in legs[first:])
    return sum(bool(leg["moved"]) for leg in legs[:first]) if reached else None


def is_mismatch(leg: dict[str, Any]) -> bool:
    """Whether a leg, or an action, found something missing at its target.

    A leg that was not driven to its end tells nothing about that.
    """
    return bool(leg["outcome"] in _ENDED_THERE and leg["mismatch"] > 0.0)


_ENDED_THERE = ("success", "out_of_reach")
