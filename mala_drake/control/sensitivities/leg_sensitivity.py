"""How a leg moves with the MPC's parameters: closed-loop sensitivities (paper, Sec. "MPC Sensitivities").

The loop is z_{i+1} = f*(z_i, u_i), u_i = pi(z_i, p). Three slips of the paper's formulas are set right here:

- Forward mode leaves out that the applied control answers to the state. With it,
  dz_{i+1}/dp = (df/dz + df/du dpi/dz) dz_i/dp + df/du dpi/dp.
- So does the adjoint, whose f must also be taken at the sample the step starts from:
  lambda^i = (df/dz + df/du dpi/dz)' lambda^{i+1}, all derivatives at z_i and u_i.
- The sum over i then runs from 0 to tau - 1, and pairs the step from z_i with lambda^{i+1}:
  dmu/dp' = sum_i (df/du dpi/dp)' lambda^{i+1}.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.messages import Message

from .closed_loop import ClosedLoopRun

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LegDerivative(Message):
    """The derivative of a leg with respect to n numbers."""

    states: Vector  # Of z_0 ... z_tau, shape (tau + 1, 6, n).
    controls: Vector  # Of u_0 ... u_{tau-1}, shape (tau, 3, n).


@dataclass(frozen=True, slots=True, eq=False)
class ForwardSensitivity(Message):
    """The derivatives of a leg with respect to the knobs, to z_0, and to the parameters of f* (the MPC's held)."""

    by_knobs: LegDerivative
    by_initial_state: LegDerivative
    by_model: LegDerivative


@dataclass(frozen=True, slots=True, eq=False)
class AdjointSensitivity(Message):
    """The gradient of one scalar of the leg."""

    by_knobs: Vector  # Shape (m,).
    by_initial_state: Vector  # Shape (6,).
    by_model: Vector  # With respect to the parameters of f*, shape (6 + ...,).


def forward(run: ClosedLoopRun) -> ForwardSensitivity:
    """Derivatives of every state and control of the leg, from the first step to the last."""
    first = run.steps[0]
    knobs, size = first.policy_by_knobs.shape[1], len(first.state)
    own = first.transition.by_parameters.shape[1]
    derivative = np.hstack((np.zeros((size, knobs)), np.eye(size), np.zeros((size, own))))
    states, controls = [derivative], []
    for step in run.steps:
        control = step.policy_by_state @ derivative
        control[:, :knobs] += step.policy_by_knobs
        derivative = step.transition.by_state @ derivative + step.transition.by_control @ control
        derivative[:, knobs + size :] += step.transition.by_parameters
        states.append(derivative)
        controls.append(control)
    parts = (np.split(np.array(rows), (knobs, knobs + size), axis=2) for rows in (states, controls))
    return ForwardSensitivity(*(LegDerivative(*part) for part in zip(*parts, strict=True)))


def adjoint(
    run: ClosedLoopRun,
    end_gradient: ArrayLike,
    state_gradients: ArrayLike | None = None,
    control_gradients: ArrayLike | None = None,
) -> AdjointSensitivity:
    """The gradient of mu(z_tau) + sum_i G(z_i, u_i), from the last step to the first.

    Args:
        run: the leg.
        end_gradient: d mu / d z_tau, shape (6,), for example of a location's membership.
        state_gradients: d G / d z_i, shape (tau, 6); none if left out.
        control_gradients: d G / d u_i, shape (tau, 3); none if left out.
    """
    count = len(run.steps)
    by_states = np.zeros((count, len(run.steps[0].state))) if state_gradients is None else np.asarray(state_gradients)
    by_controls = np.zeros_like(run.controls) if control_gradients is None else np.asarray(control_gradients)
    multiplier = np.array(end_gradient, dtype=float)
    first = run.steps[0]
    by_knobs = np.zeros(first.policy_by_knobs.shape[1])
    by_model = np.zeros(first.transition.by_parameters.shape[1])
    for step, by_state, by_control in zip(reversed(run.steps), by_states[::-1], by_controls[::-1], strict=True):
        force = step.transition.by_control.T @ multiplier + by_control
        by_knobs += step.policy_by_knobs.T @ force
        by_model += step.transition.by_parameters.T @ multiplier
        multiplier = step.transition.by_state.T @ multiplier + step.policy_by_state.T @ force + by_state
    return AdjointSensitivity(by_knobs, multiplier, by_model)
