"""Where in an episode's sums one action ends and the next one begins."""

from __future__ import annotations

from typing import Any

from pydrake.common.containers import namedview

SUMMED = ("duration", "risk", "charge_used", "discomfort")
"""What is summed up action by action: seconds, risk, charge and discomfort."""

ActionMarks = namedview(
    "ActionMarks",
    [
        "current",  # Sequence of the action that is measured, 0 for none.
        *(f"{name}_before" for name in SUMMED),  # The episode's sums when it began.
        "finished",  # Sequence of the newest action that has ended, 0 before the first.
        *SUMMED,  # What that one cost.
    ],
)
"""A view of a vector of numbers, all zero at the beginning of an episode."""


def mark_action(marks: Any, sums: Any, *, current: int, working: bool) -> None:
    """Takes in which action is under way now, and closes the one before.

    Args:
        marks: `ActionMarks`, changed in place.
        sums: of the episode up to now, with the attributes `SUMMED`.
        current: sequence of the newest action.
        working: whether the episode's task goes on.
    """
    if working and current == marks.current:
        return
    if marks.current > 0:
        marks.finished = marks.current
        for name in SUMMED:
            setattr(marks, name, getattr(sums, name) - getattr(marks, f"{name}_before"))
    marks.current = current if working else 0
    for name in SUMMED:
        setattr(marks, f"{name}_before", getattr(sums, name))
