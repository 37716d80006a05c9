"""The state estimator: from the plant to what the robot believes about itself."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from mala_drake.clock import SENSE_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.randomness import keyed_generator
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, planar_state_of

_SIZE = 6
_YAW = 2


class StateEstimator(LeafSystem):
    """Samples the robot's planar state once a tick, optionally late and with noise.

    .. pydrake_system::

        name: StateEstimator
        input_ports:
        - plant_state
        output_ports:
        - robot_state

    `plant_state` is the robot's own state port (see `mala_drake.robot.plant_state`). `robot_state` is
    [x, y, yaw, v_x, v_y, omega_z]: metres and radians in the world, yaw in [-pi, pi], velocities along the heading and
    to its left, m/s, rad/s.

    The noise of a sample depends on the seed, the episode and the number of the tick alone, so that a run resumed at
    any episode sees what the uninterrupted run would have seen. The episode is a parameter of the context, because one
    diagram serves many episodes; see `SetEpisode`.
    """

    def __init__(self, *, noise: Sequence[float] = (0.0,) * _SIZE, delay: int = 0, seed: int = 0) -> None:
        """Declares the estimator.

        Args:
            noise: standard deviation of each entry of `robot_state`, >= 0.
            delay: age of the estimate when it is sampled, in ticks, >= 0.
            seed: of the run.

        Raises:
            BadInput: a deviation or the delay is negative or not finite, or the noise has not six entries.
        """
        super().__init__()
        if len(noise) != _SIZE or not all(math.isfinite(value) and value >= 0.0 for value in noise):
            raise BadInput("state estimator noise", repr(tuple(noise)), "six finite standard deviations >= 0")
        if delay < 0:
            raise BadInput("state estimator delay", repr(delay), "a number of ticks >= 0")
        self._noise = np.array(noise, dtype=float)
        self._seed = seed
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._episode = self.DeclareNumericParameter(BasicVector([0.0]))
        # A row a tick, the newest last: the first is the one that is out by now.
        self._samples = self.DeclareDiscreteState((delay + 1) * _SIZE)
        self.DeclareVectorOutputPort(
            "robot_state",
            _SIZE,
            self._calc_robot_state,
            prerequisites_of_calc={self.discrete_state_ticket(self._samples)},
        )
        self.DeclareInitializationDiscreteUpdateEvent(self._fill)
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, SENSE_OFFSET, self._sample)

    def SetEpisode(self, context: Context, episode: int) -> None:
        """Tells which episode (>= 0) this context runs; `context` is this system's own."""
        context.get_mutable_numeric_parameter(self._episode).SetAtIndex(0, float(episode))

    def _fill(self, context: Context, discrete_state: DiscreteValues) -> None:
        """Before the first tick the robot has always been where it starts."""
        samples = discrete_state.get_mutable_vector(self._samples)
        samples.SetFromVector(np.tile(self._measure(context), samples.size() // _SIZE))

    def _sample(self, context: Context, discrete_state: DiscreteValues) -> None:
        samples = discrete_state.get_mutable_vector(self._samples)
        samples.SetFromVector(np.concatenate((samples.value()[_SIZE:], self._measure(context))))

    def _measure(self, context: Context) -> np.ndarray:
        measured = np.array(planar_state_of(self._plant_state.Eval(context).tolist()))
        if self._noise.any():
            episode = int(context.get_numeric_parameter(self._episode).GetAtIndex(0))
            tick = round(context.get_time() / TICK)
            generator = keyed_generator(self._seed, episode, f"state_estimator/{tick}")
            measured += self._noise * generator.standard_normal(_SIZE)
            measured[_YAW] = math.remainder(measured[_YAW], 2.0 * math.pi)
        return measured

    def _calc_robot_state(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(self._samples).value()[:_SIZE])
