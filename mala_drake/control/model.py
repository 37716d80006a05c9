"""The MPC's prediction model of the differential-drive robot (facts of the case, Sec. "Robot"; paper, p^f).

State z = [x, y, yaw, v_x, v_y, omega_z] (metres, radians, body-frame velocities), control
u = [propulsion, brake, yaw acceleration] (m/s^2, m/s^2, rad/s^2). The functions are written once over CasADi operations
and evaluate both symbols and plain numbers.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import casadi


class StateIndex(IntEnum):
    """Layout of the state z."""

    X = 0
    Y = 1
    YAW = 2
    FORWARD_VELOCITY = 3
    LATERAL_VELOCITY = 4
    YAW_RATE = 5


class ControlIndex(IntEnum):
    """Layout of the control u."""

    PROPULSION = 0
    BRAKE = 1
    YAW_ACCELERATION = 2


class DynamicsIndex(IntEnum):
    """Layout of the vector form of p^f."""

    LATERAL_DAMPING = 0
    LATERAL_COUPLING = 1
    YAW_COUPLING = 2
    PROPULSION_GAIN = 3
    BRAKE_GAIN = 4
    YAW_GAIN = 5


STATE_SIZE = len(StateIndex)
CONTROL_SIZE = len(ControlIndex)
DYNAMICS_SIZE = len(DynamicsIndex)


def derivative(state: Any, control: Any, dynamics: Any) -> Any:
    """Continuous-time dynamics z' = f(z, u; p^f).

    The body-frame velocity turns into the world frame; v_x' = gain propulsion - gain brake, the lateral slip obeys
    v_y' = -k v_y + g v_x omega, and omega' = gain alpha - c v_x omega carries the gyroscopic effect. The brake is
    smooth and signed here; that it never pushes backward is the business of the optimal control problem.

    Args:
        state: z, shape (6,).
        control: u, shape (3,).
        dynamics: p^f in the order of `DynamicsIndex`, shape (6,).

    Returns:
        z', a CasADi column of shape (6, 1).
    """
    yaw, forward, lateral, yaw_rate = (state[i] for i in range(StateIndex.YAW, STATE_SIZE))
    cosine, sine = casadi.cos(yaw), casadi.sin(yaw)
    turning = forward * yaw_rate
    return casadi.vertcat(
        forward * cosine - lateral * sine,
        forward * sine + lateral * cosine,
        yaw_rate,
        dynamics[DynamicsIndex.PROPULSION_GAIN] * control[ControlIndex.PROPULSION]
        - dynamics[DynamicsIndex.BRAKE_GAIN] * control[ControlIndex.BRAKE],
        dynamics[DynamicsIndex.LATERAL_COUPLING] * turning - dynamics[DynamicsIndex.LATERAL_DAMPING] * lateral,
        dynamics[DynamicsIndex.YAW_GAIN] * control[ControlIndex.YAW_ACCELERATION]
        - dynamics[DynamicsIndex.YAW_COUPLING] * turning,
    )


def step(state: Any, control: Any, dynamics: Any, period: float) -> Any:
    """One classical Runge-Kutta step of fourth order over `period` seconds with the control held.

    Stable for the lateral mode while k * period < 2.78.
    """
    slope_1 = derivative(state, control, dynamics)
    slope_2 = derivative(state + period / 2 * slope_1, control, dynamics)
    slope_3 = derivative(state + period / 2 * slope_2, control, dynamics)
    slope_4 = derivative(state + period * slope_3, control, dynamics)
    return state + period / 6 * (slope_1 + 2 * slope_2 + 2 * slope_3 + slope_4)


def step_function(period: float) -> casadi.Function:
    """The step as a CasADi function (state, control, dynamics) -> next state."""
    state = casadi.SX.sym("state", STATE_SIZE)
    control = casadi.SX.sym("control", CONTROL_SIZE)
    dynamics = casadi.SX.sym("dynamics", DYNAMICS_SIZE)
    next_state = step(state, control, dynamics, period)
    names = ["state", "control", "dynamics"]
    return casadi.Function("step", [state, control, dynamics], [next_state], names, ["next_state"])
