"""What a leg costs, as a smooth function of its trajectory: w' f of the features that the feature meter measures.

The paper's rule for p^g differentiates G, the controller's own tracking cost, while the mismatch E^C that it multiplies
is one of the action's cost. Taken literally, the explicit part dG/dp^g = (error)^2 > 0 prevails, and a leg that is
dearer than predicted makes all weights smaller, which changes neither the leg nor the mismatch. Here the derivative is
that of the cost which E^C measures, so that the rule descends on E^C squared; G enters by what it makes the robot do.

- Time: the seconds in which the robot is not at the target pose, each by 1 - mu with a Gaussian mu as wide as the
  tolerances that end a leg. A trajectory that is later by dt costs dt more.
- Charge: the drive's power by the model's state and control.
- Discomfort: the rate of `mala_drake.ward.features`, with speeds and distances rounded off at zero.
- Approach error: of the last pose.

Risk is left out: the integral of the congestion over a given way does not depend on how it is driven, and congestion
jumps at the borders of zones, so that its derivative at points in time would be wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.clock import TICK
from mala_drake.control.leg import LegRules, Pose
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE, ControlIndex, StateIndex
from mala_drake.messages import Message, Shape
from mala_drake.preferences import CRITERIA
from mala_drake.ward.features import COMFORT_RADIUS, IDEAL_HAND_OVER, STANDING_DISCOMFORT

Vector = NDArray[np.float64]
ChargeRate = Callable[[tuple[casadi.SX, casadi.SX], tuple[casadi.SX, casadi.SX, casadi.SX]], casadi.SX]
"""((forward velocity, yaw rate), (propulsion, brake, yaw acceleration)) -> charge per second, in CasADi operations."""

_ROUNDING = 1e-3  # Metres, m/s, radians below which a magnitude is rounded off.
_SECOND, _, _CHARGE, _DISCOMFORT, _ERROR = range(len(CRITERIA))


@dataclass(frozen=True, slots=True, eq=False)
class LegCostGradient(Message):
    """The cost of a leg of tau steps and its derivatives, in the form that `adjoint` takes."""

    value: float
    by_states: Vector  # Of z_0 ... z_{tau-1}, shape (tau, 6).
    by_controls: Vector  # Shape (tau, 3).
    by_end: Vector  # Of z_tau, shape (6,).


class LegCost:
    """Prices a trajectory."""

    def __init__(
        self,
        *,
        bed: Shape | None,
        charge_rate: ChargeRate,
        ideal: Pose = IDEAL_HAND_OVER,
        rules: LegRules | None = None,
        period: float = TICK,
    ) -> None:
        """States the cost.

        Args:
            bed: of the patient; None if nobody is to be disturbed.
            charge_rate: of the robot.
            ideal: the pose from which the patient would like things to be handed over.
            rules: whose tolerances say when the robot is at its target.
            period: seconds of one step.
        """
        tolerances = rules or LegRules()
        state, control = casadi.SX.sym("state", STATE_SIZE), casadi.SX.sym("control", CONTROL_SIZE)
        target, prices = casadi.SX.sym("target", 3), casadi.SX.sym("prices", len(CRITERIA))
        away = 1.0 - _at(state, target, tolerances)
        rate = prices[_SECOND] * away + prices[_CHARGE] * charge_rate(*_motion(state, control))
        if bed is not None:
            rate += prices[_DISCOMFORT] * _discomfort_rate(state, bed)
        running, end = period * rate, prices[_ERROR] * _approach_error(state, ideal)
        gradients = [casadi.gradient(running, symbol) for symbol in (state, control)]
        self._running = casadi.Function("running", [state, control, target, prices], [running, *gradients])
        self._end = casadi.Function("end", [state, prices], [end, casadi.gradient(end, state)])

    def __call__(self, states: ArrayLike, controls: ArrayLike, target: Pose, prices: ArrayLike) -> LegCostGradient:
        """The cost of a leg to `target`.

        Args:
            states: z_0 ... z_tau, shape (tau + 1, 6).
            controls: shape (tau, 3).
            target: the pose to stop at.
            prices: what a second, a risk, a charge, a discomfort and an approach error cost, shape (5,).
        """
        z, price = np.asarray(states, dtype=float), np.asarray(prices, dtype=float)
        value, by_states, by_controls = self._running(z[:-1].T, np.asarray(controls).T, np.array(target), price)
        end, by_end = self._end(z[-1], price)
        return LegCostGradient(
            value=float(casadi.sum2(value)) + float(end),
            by_states=by_states.full().T,
            by_controls=by_controls.full().T,
            by_end=by_end.full()[:, 0],
        )


def _motion(
    state: casadi.SX, control: casadi.SX
) -> tuple[tuple[casadi.SX, casadi.SX], tuple[casadi.SX, casadi.SX, casadi.SX]]:
    propulsion, brake, yaw_acceleration = (control[i] for i in ControlIndex)
    return (state[StateIndex.FORWARD_VELOCITY], state[StateIndex.YAW_RATE]), (propulsion, brake, yaw_acceleration)


def _at(state: casadi.SX, target: casadi.SX, tolerances: LegRules) -> casadi.SX:
    """Mu of being at the target pose."""
    position = (state[StateIndex.X] - target[0]) ** 2 + (state[StateIndex.Y] - target[1]) ** 2
    chord = 2.0 * casadi.sin((state[StateIndex.YAW] - target[2]) / 2.0)  # The yaw error, periodic and smooth.
    far = position / tolerances.position_tolerance**2 + chord**2 / tolerances.yaw_tolerance**2
    return casadi.exp(-far / 2.0)


def _discomfort_rate(state: casadi.SX, bed: Shape) -> casadi.SX:
    dx, dy = state[StateIndex.X] - bed.x, state[StateIndex.Y] - bed.y
    cosine, sine = np.cos(bed.yaw), np.sin(bed.yaw)
    along = casadi.fabs(cosine * dx + sine * dy) - bed.half_length
    across = casadi.fabs(cosine * dy - sine * dx) - bed.half_width
    outside = _magnitude(casadi.fmax(along, 0.0), casadi.fmax(across, 0.0))
    distance = outside + casadi.fmin(casadi.fmax(along, across), 0.0) - bed.radius
    closeness = casadi.fmax(0.0, casadi.fmin(1.0, 1.0 - distance / COMFORT_RADIUS))
    speed = _magnitude(state[StateIndex.FORWARD_VELOCITY], state[StateIndex.LATERAL_VELOCITY])
    return closeness * (STANDING_DISCOMFORT + speed)


def _approach_error(state: casadi.SX, ideal: Pose) -> casadi.SX:
    distance = _magnitude(state[StateIndex.X] - ideal[0], state[StateIndex.Y] - ideal[1])
    error = state[StateIndex.YAW] - ideal[2]
    turn = _magnitude(casadi.atan2(casadi.sin(error), casadi.cos(error)))
    return 0.5 * casadi.fmin(distance / 4.0, 1.0) + 0.5 * turn / np.pi


def _magnitude(*components: casadi.SX) -> casadi.SX:
    return casadi.sqrt(sum(component**2 for component in components) + _ROUNDING**2)
