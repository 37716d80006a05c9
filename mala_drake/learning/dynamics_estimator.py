"""Grey-box dynamics (row C14): the controller's own model, with coefficients estimated from what the robot did.

The known part is the model f(z, v; p^f) of `mala_drake.control.model`. The residual is linear in its features: gains of
propulsion, brake and turning (mass, inertia, wheel radii), the coupling of speed and yaw rate (gyroscopic effect, a
centre of mass off the axle) and the lateral slip. From logged (z, v, z+) the coefficients are estimated recursively, as
the state of an extended Kalman filter that measures velocities one period later. With the slopes H of one predicted
velocity by p^f, the covariance P and the noise variance r of that velocity,

    e = y - f(z, v; p),  s = H P H' + r,  p <- p + P H' e / s,  P <- P - P H' H P / s.

Four things make it fit for a running robot. Influence is bounded (P. J. Huber, Robust Statistics, 1981): an innovation
beyond a few standard deviations counts only as that many. The noise is estimated too. What the robot does not excite is
not learned from, and forgetting acts in the excited direction alone (R. Kulhavy, Automatica 23, 1987), so that driving
straight blows nothing up. And samples that the model does not describe are left out.

Bounds l and h keep the coefficients those of a model that can be stepped. An estimate that leaves them is replaced by
the most likely one within (D. Simon, IET Control Theory and Applications 4, 2010),

    p <- argmin (q - p)' P^-1 (q - p), l <= q <= h,  which is  p + P[:, i] (b - p_i) / P[i, i]  for one active bound b.

So whatever is correlated with the coefficient that is held is corrected with it: the slip answers nearly at once, and
samples tell of k and g little more than g / k. P stays. Around the new p it means the same cost as around the old one,
but for a multiple of q_i - b, which is zero on the bound. So nothing is lost while the bound holds; that multiple, how
hard the samples press on it, is forgotten on purpose, so that it neither winds up nor keeps the estimate there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi
import numpy as np

from mala_drake.clock import TICK
from mala_drake.control.model import (
    CONTROL_SIZE,
    DYNAMICS_SIZE,
    STATE_SIZE,
    ControlIndex,
    StateIndex,
    step,
)
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.learning.nearest_in_box import nearest_in_box
from mala_drake.messages import LearnedDynamics

_VELOCITIES = (StateIndex.FORWARD_VELOCITY, StateIndex.LATERAL_VELOCITY, StateIndex.YAW_RATE)
_TRIANGLE = np.tril_indices(DYNAMICS_SIZE)
_COVARIANCE = slice(DYNAMICS_SIZE, DYNAMICS_SIZE + len(_TRIANGLE[0]))
_NOISE = slice(_COVARIANCE.stop, _COVARIANCE.stop + len(_VELOCITIES))
_COUNTS = slice(_NOISE.stop, _NOISE.stop + len(_VELOCITIES))

NOMINAL_DEVIATIONS = (3.0, 0.2, 0.3, 0.1, 0.1, 0.1)
"""How far from nominal each coefficient may well be, as a standard deviation, in the order of `DynamicsIndex`."""

# Wheels that hold have an endless k: it is learned up to its bound.
_LOWEST = np.array([1.0, -1.0, -1.5, 0.6, 0.6, 0.6])
_HIGHEST = np.array([11.0, 1.0, 1.5, 1.4, 1.4, 1.4])

_FIRST_NOISE = 0.01  # Standard deviation of a velocity before any is known, m/s and rad/s.
_LEAST_NOISE = 1e-4
_NOISE_PRIOR = 5.0  # Samples that the first noise is worth.


@dataclass(frozen=True, slots=True, eq=False)
class Transition:
    """One logged (z, v, z+): two states a period apart, and the control between them."""

    before: FloatArray  # z, shape (6,).
    control: FloatArray  # v, shape (3,).
    after: FloatArray  # z+, shape (6,).


class DynamicsEstimator(AbstractLearner):
    """Estimates p^f, with standard deviations.

    Like other learners it holds settings only; what it has learned is one vector of numbers: the coefficients, their
    covariance (its lower triangle), the noise variances of the three velocities and how many samples each of them was
    learned from, and the number of samples in all.
    """

    def __init__(
        self,
        *,
        period: float = TICK,
        pose_noise: float = 0.0,
        velocity_noise: float = 0.0,
        least_speed: float = 0.3,
        least_excitation: float = 0.003,
        bound: float = 2.5,
        memory: float = 150.0,
        noise_memory: float = 100.0,
    ) -> None:
        """Constructs the estimator.

        Args:
            period: between two samples, seconds.
            pose_noise: standard deviation of the measured positions, metres, or yaw, radians, whichever is larger.
            velocity_noise: standard deviation of the measured velocities, m/s and rad/s.
            least_speed: below which braking, which is passive and ends at rest, is not learned from, m/s.
            least_excitation: velocity change that coefficients off by `NOMINAL_DEVIATIONS` must at least make for a
                sample to be learned from, m/s and rad/s.
            bound: standard deviations at which the influence of an innovation ends.
            memory: samples of one direction of excitation after which what it told is forgotten; > 1.
            noise_memory: the same of the noise; > 1.

        Raises:
            BadInput: if a number is out of its range.
        """
        numbers = {"period": period, "bound": bound, "memory": memory - 1.0, "noise_memory": noise_memory - 1.0}
        for name, value in numbers.items():
            if not (math.isfinite(value) and value > 0.0):
                raise BadInput(f"dynamics {name}", repr(value), "a finite number that is large enough")
        limits = {
            "pose_noise": pose_noise,
            "velocity_noise": velocity_noise,
            "least_speed": least_speed,
            "least_excitation": least_excitation,
        }
        for name, value in limits.items():
            if not (math.isfinite(value) and value >= 0.0):
                raise BadInput(f"dynamics {name}", repr(value), "a finite number >= 0")
        self._period = period
        # Of a way or an angle: the poses' own, and that of the mean of two rates, over the period.
        self._motion_noise = math.hypot(pose_noise, period * velocity_noise / math.sqrt(2.0))
        self._least_speed = least_speed
        self._least_excitation = least_excitation
        self._bound = bound
        self._forgetting = 1.0 / memory
        self._noise_forgetting = 1.0 / noise_memory
        self._predict = _prediction(period)

    def initial_state(self) -> FloatArray:
        """The state before any sample: (34,)."""
        return _packed(
            DynamicsParameters().vector,
            np.diag(np.square(NOMINAL_DEVIATIONS)),
            np.full(len(_VELOCITIES), _FIRST_NOISE**2),
            np.zeros(len(_VELOCITIES)),
            0.0,
        )

    def update(self, state: FloatArray, transition: Transition) -> FloatArray:
        """The state after one sample; unchanged, bit for bit, if the sample says nothing.

        Args:
            state: before; not modified.
            transition: the sample.
        """
        if not self.describes(transition):
            return state
        coefficients, covariance, noise, counts = _unpacked(state)
        for i, velocity in enumerate(_VELOCITIES):
            predicted, slopes = self.prediction(transition, coefficients)
            if np.linalg.norm(slopes[i] * NOMINAL_DEVIATIONS) < self._least_excitation:
                continue
            innovation = float(transition.after[velocity]) - float(predicted[velocity])
            surprise = self._correct(coefficients, covariance, noise[i], innovation, slopes[i])
            counts[i] += 1.0
            step_of_noise = max(self._noise_forgetting, 1.0 / (counts[i] + _NOISE_PRIOR))
            noise[i] += step_of_noise * (max(surprise, _LEAST_NOISE**2) - noise[i])
        if np.array_equal(counts, state[_COUNTS]):
            return state
        return _packed(coefficients, covariance, noise, counts, state[-1] + 1.0)

    def describes(self, transition: Transition) -> bool:
        """Whether the sample is one that the model describes.

        It does not describe a parked robot, nor the end of braking, where the passive brake lets go; and samples whose
        motion contradicts their rates were not taken a period apart.
        """
        t = transition
        numbers = np.concatenate((t.before, t.control, t.after))
        if not np.isfinite(numbers).all() or _parked(t.control):
            return False
        braking = t.control[ControlIndex.BRAKE] > 0.0
        speeds = t.before[StateIndex.FORWARD_VELOCITY], t.after[StateIndex.FORWARD_VELOCITY]
        if braking and min(speeds) < self._least_speed:
            return False
        way = float(np.hypot(*(t.after - t.before)[[StateIndex.X, StateIndex.Y]]))
        turned = math.remainder(float(t.after[StateIndex.YAW] - t.before[StateIndex.YAW]), math.tau)
        half = 0.5 * self._period
        turning = half * (t.before[StateIndex.YAW_RATE] + t.after[StateIndex.YAW_RATE])
        return self._agree(way, abs(half * sum(speeds))) and self._agree(turned, float(turning))

    def _agree(self, measured: float, expected: float) -> bool:
        """Whether a way (m) or an angle (rad) agrees with the mean of the rates at its ends."""
        return abs(measured - expected) <= 1e-3 + 0.02 * abs(expected) + 4.0 * self._motion_noise

    def prediction(self, transition: Transition, coefficients: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the model predicts of a transition: z+, (6,), and the slopes of its velocities by p^f, (3, 6)."""
        predicted, slopes = self._predict(transition.before, transition.control, coefficients)
        return np.array(predicted).ravel(), np.array(slopes)

    def coefficients(self, state: FloatArray) -> FloatArray:
        """The estimate of p^f: (6,)."""
        return state[:DYNAMICS_SIZE].copy()

    def deviations(self, state: FloatArray) -> FloatArray:
        """The standard deviation of each coefficient: (6,).

        It is what the samples tell by themselves, near the estimate. Of a coefficient on its bound it does not tell how
        far beyond the samples would have it.
        """
        _, covariance, _, _ = _unpacked(state)
        return np.sqrt(np.diag(covariance))

    def updates(self, state: FloatArray) -> int:
        """The number of samples learned from."""
        return int(state[-1])

    def learned(self, state: FloatArray) -> LearnedDynamics:
        """What the controller is told; nothing before the first sample."""
        if self.updates(state) == 0:
            return LearnedDynamics()
        coefficients, deviations = self.coefficients(state), self.deviations(state)
        return LearnedDynamics(tuple(coefficients.tolist()), tuple(deviations.tolist()), self.updates(state))

    def _correct(
        self, coefficients: FloatArray, covariance: FloatArray, noise: float, innovation: float, slopes: FloatArray
    ) -> float:
        """Corrects coefficients and covariance in place by one measured velocity; returns its share of the noise."""
        # Forgetting: less is believed of what this sample tells about, and as much as before of all else.
        seen = covariance @ slopes
        believed = float(slopes @ seen)
        covariance += self._forgetting / (1.0 - self._forgetting) / believed * np.outer(seen, seen)
        seen, believed = seen / (1.0 - self._forgetting), believed / (1.0 - self._forgetting)
        total = believed + noise
        bounded = min(abs(innovation), self._bound * math.sqrt(total))
        coefficients += seen * (math.copysign(bounded, innovation) / total)
        # What is beyond the bound tells as little as a measurement whose noise is as much larger.
        weight = bounded / abs(innovation) if innovation else 1.0
        covariance -= np.outer(seen, seen) / (believed + noise / weight)
        coefficients[:] = nearest_in_box(coefficients, covariance, _LOWEST, _HIGHEST)
        return bounded**2 - believed


def _prediction(period: float) -> casadi.Function:
    """The model's step, and the slopes of its velocities by p^f: (z, v, p^f) -> (z+, slopes)."""
    state = casadi.SX.sym("state", STATE_SIZE)
    control = casadi.SX.sym("control", CONTROL_SIZE)
    dynamics = casadi.SX.sym("dynamics", DYNAMICS_SIZE)
    predicted = step(state, control, dynamics, period)
    slopes = casadi.jacobian(predicted[list(map(int, _VELOCITIES))], dynamics)
    return casadi.Function("prediction", [state, control, dynamics], [predicted, casadi.densify(slopes)])


def _parked(control: FloatArray) -> bool:
    """Nothing but braking: the parking brake holds the wheels."""
    return bool(control[ControlIndex.PROPULSION] == 0.0 == control[ControlIndex.YAW_ACCELERATION])


def _packed(
    coefficients: FloatArray, covariance: FloatArray, noise: FloatArray, counts: FloatArray, updates: float
) -> FloatArray:
    return np.concatenate((coefficients, covariance[_TRIANGLE], noise, counts, [updates]))


def _unpacked(state: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Copies of coefficients, (6,), covariance, (6, 6), noise variances, (3,), and samples by velocity, (3,)."""
    covariance = np.zeros((DYNAMICS_SIZE, DYNAMICS_SIZE))
    covariance[_TRIANGLE] = state[_COVARIANCE]
    covariance += np.tril(covariance, -1).T
    return state[:DYNAMICS_SIZE].copy(), covariance, state[_NOISE].copy(), state[_COUNTS].copy()
