"""d pi / d (p, z_0): the sensitivity of the applied control alone, in time that does not grow with the parameters.

Of the linear system of the paper's eq. (IFT) only three rows of the inverse are needed. They are one Riccati sweep
forward: the response of the horizon to a unit force on each entry of u_0. What a parameter does to the KKT system is
then weighted by that response.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE

from .columns import INITIAL_STATE, LOWER, UPPER, Columns
from .kkt_point import KktPoint
from .parameter_terms import ParameterTerms

Vector = NDArray[np.float64]


def policy_sensitivity(point: KktPoint, terms: ParameterTerms, columns: Columns, groups: Iterable[str]) -> Vector:
    """The derivative d u_0 / d (p, z_0), shape (3, columns.size); columns outside of `groups` are zero.

    Args:
        point: where.
        terms: of the same problem.
        columns: of the same problem.
        groups: names of groups or pieces, for which the columns are computed.
    """
    wanted = columns.groups(groups)
    states, controls, costates = _response(point)
    jacobian = np.zeros((CONTROL_SIZE, columns.size))
    both = np.concatenate((states[1:], controls), axis=1)
    for term in terms.nodes(point, wanted):
        places = term.columns.ravel()
        for row, direction in zip(jacobian, both[:, term.rows].transpose(2, 0, 1), strict=True):
            row -= np.bincount(places, (term.values * direction).ravel(), columns.size)
    if "dynamics" in wanted:
        moved = terms.dynamics(point)
        before = np.concatenate((states[:-1], controls), axis=1)
        place = columns.slices["dynamics"]
        jacobian[:, place] = -(np.tensordot(before, moved.mixed, ((0, 1), (0, 1))))
        jacobian[:, place] -= np.tensordot(costates, moved.offset, ((0, 1), (0, 1)))
    if "inputs" in wanted:
        jacobian[:, columns.slices[LOWER]] = (controls * point.lower_curvature[:, :, None]).sum(axis=0).T
        jacobian[:, columns.slices[UPPER]] = (controls * point.upper_curvature[:, :, None]).sum(axis=0).T
    if "initial_state" in wanted:
        jacobian[:, columns.slices[INITIAL_STATE]] = -point.factorisation.gain[0]
    return jacobian


def _response(point: KktPoint) -> tuple[Vector, Vector, Vector]:
    """States, controls and costates of the linearised KKT system under a unit force on each entry of u_0.

    Shapes (N + 1, 6, 3), (N, 3, 3), (N, 6, 3): the last axis is the force.
    """
    f = point.factorisation
    horizon = len(f.gradient)
    states = np.zeros((horizon + 1, STATE_SIZE, CONTROL_SIZE))
    controls = np.zeros((horizon, CONTROL_SIZE, CONTROL_SIZE))
    controls[0] = f.inverse[0]
    states[1] = f.B[0] @ controls[0]
    for k in range(1, horizon):
        np.matmul(-f.gain[k], states[k], out=controls[k])
        states[k + 1] = f.A[k] @ states[k] + f.B[k] @ controls[k]
    costates = f.value @ states[1:] + f.cross.transpose(0, 2, 1) @ controls
    return states, controls, costates
