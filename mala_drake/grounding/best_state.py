"""The principled defuzzification: the crisp state that matches the observation best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.aggregation import state_truth
from mala_drake.grounding.norms import AbstractNorms


@dataclass(frozen=True, slots=True)
class BestState:
    """A crisp state and how true it is."""

    index: int  # Row of the candidates.
    truth: float  # In (0, 1].


def best_state(values: npt.ArrayLike, states: npt.ArrayLike, *, norms: AbstractNorms) -> BestState | None:
    """The argmax over s of the conjunction of mu_L(z) (paper, Sec. "Updating the Planning State and Model").

    Args:
        values: memberships of the M atoms, (M,).
        states: candidate crisp states, (S, M), bool: for instance those the planner considers reachable, in which
            mutually exclusive atoms are never both true.
        norms: the logic of the conjunction.

    Returns:
        The best candidate, the first of equals; None when no candidate is true to any degree, as strict logics such
        as Lukasiewicz' often say, or there is none.
    """
    truths = state_truth(values, states, norms=norms)
    if truths.size == 0:
        return None
    index = int(np.argmax(truths))
    # A NaN, from a state that is not a number, is no evidence for anything.
    return BestState(index, float(truths[index])) if truths[index] > 0.0 else None
