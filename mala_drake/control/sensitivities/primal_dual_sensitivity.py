"""d zeta / d (p, z_0): the sensitivity of the whole primal-dual solution, paper eq. (IFT).

The linear system is solved for all right-hand sides at once by the Riccati recursion: one sweep backward, one forward,
in time linear in the horizon; no matrix over the horizon is ever formed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.messages import Message

from .columns import INITIAL_STATE, LOWER, UPPER, Columns
from .kkt_point import KktPoint
from .parameter_terms import ParameterTerms

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PrimalDualSensitivity(Message):
    """The derivatives of a `KktPoint`; the last axis has the columns of `Columns`, those not asked for are zero."""

    states: Vector  # Shape (N + 1, 6, n).
    controls: Vector  # Shape (N, 3, n).
    costates: Vector  # Of lambda_0 ... lambda_N, shape (N + 1, 6, n).
    lower_multipliers: Vector  # Shape (N, 3, n).
    upper_multipliers: Vector  # Shape (N, 3, n).


@dataclass(slots=True)
class _RightHandSide:
    """d kappa / d p by its rows, each with the columns last."""

    nodes: Vector  # Gradient with respect to z_0 ... z_N of the nodes' costs, shape (N + 1, 6, n).
    states: Vector  # Gradient with respect to z_0 ... z_{N-1} of lambda' f, shape (N, 6, n).
    controls: Vector  # Gradient with respect to u_k, shape (N, 3, n).
    offsets: Vector  # Of f, shape (N, 6, n).
    initial_state: Vector  # Shape (6, n).


def primal_dual_sensitivity(
    point: KktPoint, terms: ParameterTerms, columns: Columns, groups: Iterable[str]
) -> PrimalDualSensitivity:
    """The derivatives of all primal and dual variables with respect to the columns of `groups`."""
    wanted = columns.groups(groups)
    rhs = _right_hand_side(point, terms, columns, wanted)
    f = point.factorisation
    horizon, size = len(f.gradient), columns.size
    linear = np.zeros((horizon, STATE_SIZE, size))  # Affine part of lambda_{k+1}.
    feed_forward = np.zeros((horizon, CONTROL_SIZE, size))
    before = np.zeros((STATE_SIZE, size))
    for k in reversed(range(horizon)):
        linear[k] = rhs.nodes[k + 1] + before
        pull = f.value[k] @ rhs.offsets[k] + linear[k]
        force = rhs.controls[k] + f.B[k].T @ pull + f.cross[k] @ rhs.offsets[k]
        feed_forward[k] = f.inverse[k] @ force
        before = f.A[k].T @ pull + rhs.states[k] - f.gain[k].T @ force
    states = np.zeros((horizon + 1, STATE_SIZE, size))
    controls = np.zeros((horizon, CONTROL_SIZE, size))
    states[0] = rhs.initial_state
    for k in range(horizon):
        controls[k] = -f.gain[k] @ states[k] - feed_forward[k]
        states[k + 1] = f.A[k] @ states[k] + f.B[k] @ controls[k] + rhs.offsets[k]
    costates = np.zeros((horizon + 1, STATE_SIZE, size))
    costates[0] = (f.initial_value + np.diag(2 * _stage_weights(point))) @ states[0] + rhs.nodes[0] + before
    costates[1:] = f.value @ states[1:] + f.cross.transpose(0, 2, 1) @ controls + linear
    toward_lower, toward_upper = controls.copy(), controls.copy()
    if "inputs" in wanted:
        for moved, name in ((toward_lower, LOWER), (toward_upper, UPPER)):
            moved[:, :, columns.slices[name]] -= np.eye(CONTROL_SIZE)
    return PrimalDualSensitivity(
        states=states,
        controls=controls,
        costates=costates,
        lower_multipliers=-point.lower_curvature[:, :, None] * toward_lower,
        upper_multipliers=point.upper_curvature[:, :, None] * toward_upper,
    )


def _right_hand_side(
    point: KktPoint, terms: ParameterTerms, columns: Columns, wanted: frozenset[str]
) -> _RightHandSide:
    horizon, size = len(point.controls), columns.size
    nodes = np.zeros((horizon, STATE_SIZE + CONTROL_SIZE, size))
    stages = np.arange(horizon)[:, None]
    for term in terms.nodes(point, wanted):
        # Within one term no row and column occur twice.
        nodes[stages, term.rows, term.columns] += term.values
    first_node = np.zeros((1, STATE_SIZE, size))
    if "stage" in wanted:
        place = columns.slices["stage.references"].start
        error = point.states[0] - point.packed[place : place + STATE_SIZE]
        first_node[0, :, place : place + STATE_SIZE] = np.diag(-2 * _stage_weights(point))
        first_node[0, :, columns.slices["stage.state_weights"]] = np.diag(2 * error)
    rhs = _RightHandSide(
        nodes=np.concatenate((first_node, nodes[:, :STATE_SIZE])),
        states=np.zeros((horizon, STATE_SIZE, size)),
        controls=nodes[:, STATE_SIZE:],
        offsets=np.zeros((horizon, STATE_SIZE, size)),
        initial_state=np.zeros((STATE_SIZE, size)),
    )
    if "dynamics" in wanted:
        place = columns.slices["dynamics"]
        moved = terms.dynamics(point)
        rhs.offsets[:, :, place] = moved.offset
        rhs.states[:, :, place] = moved.mixed[:, :STATE_SIZE]
        rhs.controls[:, :, place] = moved.mixed[:, STATE_SIZE:]
    if "inputs" in wanted:
        diagonal = np.arange(CONTROL_SIZE)
        rhs.controls[:, diagonal, columns.slices[LOWER].start + diagonal] = -point.lower_curvature
        rhs.controls[:, diagonal, columns.slices[UPPER].start + diagonal] = -point.upper_curvature
    if "initial_state" in wanted:
        rhs.initial_state[:, columns.slices[INITIAL_STATE]] = np.eye(STATE_SIZE)
    return rhs


def _stage_weights(point: KktPoint) -> Vector:
    return point.parameters.stage.state_weights
