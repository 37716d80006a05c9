"""T^s: from single memberships to the fuzzy state, and to the truth of a whole crisp state."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.norms import AbstractNorms, FloatArray
from mala_drake.messages import Atom


def fuzzy_state(
    observed: Mapping[Atom, float], *, state: Collection[Atom], effects: Mapping[Atom, float]
) -> dict[Atom, float]:
    """The fuzzy state s^mu = T^s(mu_L1(z), ..., mu_LM(z); a_t, s_t) (paper, Sec. "Integrating State representations").

    The paper leaves open how the action and the previous state enter. Here they stand in where nothing is observed:
    an observed atom has its membership; an unobserved one that the action affects has the truth the action is
    expected to give it; any other keeps its truth in the previous state (the frame axiom).

    Args:
        observed: membership mu_L(z) of every atom that the continuous state says something about.
        state: the atoms that held before the action, s_t.
        effects: expected truth after the action a_t of every atom it may change: 1 for an added atom, 0 for a
            deleted one, or a learned probability.

    Returns:
        The degree of truth of every atom named in any of the three, sorted by atom.
    """
    truths = dict.fromkeys(state, 1.0) | dict(effects) | dict(observed)
    return {atom: truths[atom] for atom in sorted(truths)}


def state_truth(values: npt.ArrayLike, states: npt.ArrayLike, *, norms: AbstractNorms) -> FloatArray:
    """To what degree the observation shows a crisp state: the conjunction over all atoms.

    An atom that holds in the state contributes mu_L(z), one that does not contributes 1 - mu_L(z). (Written as
    the conjunction of mu_L alone, as in the paper, the degree would be the same for every state.)

    Args:
        values: memberships of the M atoms, (M,).
        states: truth of each atom in each crisp state, (..., M), bool.
        norms: the logic.

    Returns:
        One degree in [0, 1] a state, (...).
    """
    return norms.conjunction(_literals(values, states))


def state_truth_gradient(values: npt.ArrayLike, states: npt.ArrayLike, *, norms: AbstractNorms) -> FloatArray:
    """The derivative of `state_truth` with respect to the memberships, (..., M)."""
    signs = np.where(np.asarray(states, dtype=bool), 1.0, -1.0)
    return signs * norms.conjunction_gradient(_literals(values, states))


def _literals(values: npt.ArrayLike, states: npt.ArrayLike) -> FloatArray:
    degrees = np.asarray(values, dtype=float)
    return np.where(np.asarray(states, dtype=bool), degrees, 1.0 - degrees)
