"""What is kept of how well the controller's model predicts the robot: its errors a tick ahead."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.model import STATE_SIZE, StateIndex
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.messages import LearnedDynamics

Vector = NDArray[np.float64]

_VELOCITIES = slice(StateIndex.FORWARD_VELOCITY, STATE_SIZE)


class ModelErrors:
    """Collects errors of predicted velocities, tick by tick, with the nominal model and with the learned one.

    A tick is predicted with what was learned before it. As in learning, only samples count that the model describes.
    """

    def __init__(self, estimator: DynamicsEstimator) -> None:
        """Constructs it for what `estimator` learns."""
        self._estimator = estimator
        self._nominal = DynamicsParameters().vector
        self._before: tuple[Vector, Vector, Vector] | None = None  # State, control and coefficients a tick ago.
        self._squares: dict[str, list[Vector]] = {"nominal": [], "learned": []}

    def add(self, state: Vector, control: Vector, learned: LearnedDynamics) -> None:
        """Takes in a tick.

        Args:
            state: the robot's, as it is sampled in the tick, shape (6,).
            control: from then on, shape (3,).
            learned: the controller's model from then on.
        """
        if self._before is not None:
            before, applied, coefficients = self._before
            transition = Transition(before, applied, state)
            if self._estimator.describes(transition):
                for name, model in (("nominal", self._nominal), ("learned", coefficients)):
                    predicted, _ = self._estimator.prediction(transition, model)
                    self._squares[name].append(np.square((state - predicted)[_VELOCITIES]))
        coefficients = np.array(learned.coefficients) if learned.updates else self._nominal
        self._before = state.copy(), control.copy(), coefficients

    def root_mean_squares(self) -> dict[str, list[float]]:
        """By model, those of v_x, v_y (m/s) and the yaw rate (rad/s); empty when there was nothing to predict."""
        return {name: np.sqrt(np.mean(squares, axis=0)).tolist() for name, squares in self._squares.items() if squares}
