"""What the options of the command line mean: their texts as values, a mistake told by the option's name.

Heavy imports happen inside the functions, as in `cli`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mala_drake.errors import BadInput

if TYPE_CHECKING:
    from mala_drake.planning.planner import SearchName
    from mala_drake.scenario import Scenario

_SEARCHES: tuple[SearchName, ...] = ("astar", "ucs")

_MOST_SEEDS = 10_000  # Of one range: more are a slip of the hand.

_OPTION_OF = {
    "task": "--task",
    "patient.profile": "--profile",
    "episodes": "--episodes",
    "random_seed": "--seed",
    "control.solver": "--solver",
}
"""The options that set a field of the scenario."""


def chosen_scenario(
    file: Path | None, task: str | None, profile: str | None, episodes: int | None, seed: int | None, solver: str | None
) -> Scenario:
    """The scenario of the file, the default one for None, with what the options that are not None change.

    Raises:
        BadInput: for the first mistake, by the name of the field or of the option that has set it.
    """
    from mala_drake.scenario import LoadScenario, Validate, reset_unused

    chosen = LoadScenario(file)
    chosen.task = chosen.task if task is None else task
    if profile is not None:
        chosen.patient.profile, chosen.patient.true_weights = profile, []
    chosen.episodes = chosen.episodes if episodes is None else episodes
    chosen.random_seed = chosen.random_seed if seed is None else seed
    chosen.control.solver = chosen.control.solver if solver is None else solver
    reset_unused(chosen)  # What the file sets of the solver that an option has replaced.
    try:
        Validate(chosen, where="")
    except BadInput as error:
        raise BadInput(_OPTION_OF.get(error.where, error.where), error.what, error.expected) from None
    return chosen


def weights_of(text: str | None) -> tuple[float, ...] | None:
    """The preference weights of `w0,w1,w2,w3,w4`.

    Raises:
        BadInput: if they are not numbers, or not on the simplex.
    """
    if text is None:
        return None
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise BadInput("--weights", repr(text), "five numbers w0,w1,w2,w3,w4") from None
    from mala_drake.preferences import validated_weights

    return validated_weights(values, where="--weights")


def search_of(text: str) -> SearchName:
    """The search of that name.

    Raises:
        BadInput: if there is none.
    """
    chosen = next((name for name in _SEARCHES if name == text), None)
    if chosen is None:
        raise BadInput("--search", repr(text), "one of " + ", ".join(_SEARCHES))
    return chosen


def names_of(option: str, text: str | None) -> tuple[str, ...] | None:
    """The names of `one,two,three`, the text of `option`.

    Raises:
        BadInput: if one is empty.
    """
    if text is None:
        return None
    names = tuple(part.strip() for part in text.split(","))
    if not all(names):
        raise BadInput(option, repr(text), "names separated by commas")
    return names


def seeds_of(text: str | None) -> tuple[int, ...] | None:
    """The seeds of `0,1,7` or `0-4`.

    Raises:
        BadInput: if they are not whole numbers >= 0, or far too many.
    """
    if text is None:
        return None
    seeds: list[int] = []
    for part in text.split(","):
        ends = re.fullmatch(r"\s*(\d{1,9})(?:-(\d{1,9}))?\s*", part)
        numbers = range(int(ends[1]), int(ends[2] or ends[1]) + 1) if ends else range(0)
        if not 0 < len(numbers) <= _MOST_SEEDS:
            raise BadInput("--seeds", repr(text), "whole numbers >= 0, for example 0,1,7 or 0-4")
        seeds += numbers
    return tuple(seeds)
