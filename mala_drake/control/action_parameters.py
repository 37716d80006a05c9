"""What a planned action means for the controller: p(a) = (p^w, p^g, p^f, p^h, p^a), paper Sec. "Action-Triggered MPC".

The action's target and reference enter p^w and p^g; the style below is chosen by the kind of action: near the patient
the robot is steadier, and with something in its gripper it accelerates less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Action, LearnedWeights, Shape
from mala_drake.ward.congestion import Congestion

from .model import ControlIndex, StateIndex
from .parameters import (
    ConstraintParameters,
    DynamicsParameters,
    InputParameters,
    MpcParameters,
    StageParameters,
    TerminalParameters,
)
from .reference import Reference
from .weights_to_costs import DEFAULT_TRANSLATION, CostTranslation


@dataclass(frozen=True, slots=True)
class DrivingStyle:
    """The part of p(a) that does not depend on where the robot goes."""

    position_weight: float = 1.0  # Factor on Q's position entries, and on W's.
    yaw_weight: float = 1.0  # The same for the yaw,
    velocity_weight: float = 1.0  # and for the velocities.
    control_weight: float = 1.0  # Factor on R.
    clearance: float = 0.10  # Metres between body and obstacles.
    lateral_limit: float = 2.0  # |v_x omega|, m/s^2.
    propulsion_limit: float = 2.0  # m/s^2.
    brake_limit: float = 2.0  # m/s^2.
    propulsion_gain: float = 1.0  # Of the nominal model: a loaded robot answers a little less.


EMPTY_HANDED = DrivingStyle()
CARRYING = DrivingStyle(lateral_limit=1.2, propulsion_limit=1.5, brake_limit=1.6, propulsion_gain=0.99)
AT_BEDSIDE = replace(CARRYING, position_weight=36.0 / 34.0, control_weight=1.18, clearance=0.12)
"""Facts of the case: near the patient Q_pos = 36 and R = (3.6, 3.6, 2.8), the working point's 3.05 times 1.18."""


_NOMINAL_INPUTS = InputParameters()


def style_of(action: Action, *, carrying: bool) -> DrivingStyle:
    """The driving style of an action."""
    if action.name.startswith("approach"):
        return AT_BEDSIDE
    return CARRYING if carrying else EMPTY_HANDED


def learned_style(action: Action, learned: LearnedWeights, *, carrying: bool) -> DrivingStyle:
    """The driving style of an action with the factors that were learned for where it leads."""
    style = style_of(action, carrying=carrying)
    factors = dict(learned.factors).get(action.place)
    if factors is None:
        return style
    position, yaw, velocity, control = factors
    return replace(
        style,
        position_weight=style.position_weight * position,
        yaw_weight=style.yaw_weight * yaw,
        velocity_weight=style.velocity_weight * velocity,
        control_weight=style.control_weight * control,
    )


def make_parameters(
    *,
    style: DrivingStyle,
    weights: Sequence[float],
    reference: Reference,
    obstacles: Sequence[Shape],
    congestion: Congestion,
    dynamics: DynamicsParameters | None = None,
    translation: CostTranslation = DEFAULT_TRANSLATION,
) -> MpcParameters:
    """Fills the five groups for one solve.

    Args:
        style: by the action.
        weights: the preferences, from which Q and R follow.
        reference: N + 1 states; the last one is the terminal target.
        obstacles: what the sensor sees.
        congestion: limits the speed by zone.
        dynamics: p^f, nominal if None.
        translation: from the preferences to Q and R.
    """
    states = reference.states
    state_weights, control_weights = translation(weights)
    state_weights = state_weights * _state_factors(style)
    model = dynamics or DynamicsParameters(propulsion_gain=style.propulsion_gain)
    lower, upper = _NOMINAL_INPUTS.lower.copy(), _NOMINAL_INPUTS.upper.copy()
    lower[ControlIndex.PROPULSION], upper[ControlIndex.PROPULSION] = -style.propulsion_limit, style.propulsion_limit
    upper[ControlIndex.BRAKE] = style.brake_limit
    return MpcParameters(
        terminal=TerminalParameters(target=states[-1], weights=100.0 * state_weights),
        stage=StageParameters(
            references=states[:-1],
            state_weights=state_weights,
            control_weights=control_weights * style.control_weight,
        ),
        constraints=ConstraintParameters(
            speed_limits=congestion.speed_limit(states[1:, [StateIndex.X, StateIndex.Y]]),
            obstacles=tuple(obstacles),
            clearance=style.clearance,
            lateral_limit=style.lateral_limit,
        ),
        dynamics=model,
        inputs=InputParameters(lower, upper),
    )


def _state_factors(style: DrivingStyle) -> NDArray[np.float64]:
    factors = np.full(len(StateIndex), style.velocity_weight)
    factors[[StateIndex.X, StateIndex.Y]] = style.position_weight
    factors[StateIndex.YAW] = style.yaw_weight
    return factors
