"""How the end of a leg moves with its target: the closed-loop sensitivity that targets are learned through."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control.action_parameters import style_of
from mala_drake.control.leg import LegGuide, Pose
from mala_drake.control.model import STATE_SIZE, StateIndex
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import learned_parameters
from mala_drake.control.solver import Solver
from mala_drake.messages import Action, LearnedDynamics, Shape
from mala_drake.ward.congestion import Congestion

from .analysis import SensitivityAnalysis
from .closed_loop import ClosedLoop
from .leg_sensitivity import adjoint
from .recorded_leg import KNOBS, NOMINAL, LegRecorder
from .simulation_model import SimulationModel

Vector = NDArray[np.float64]

NOTHING_LEARNED = LearnedDynamics()

_FORGOTTEN = 0.1  # Metres at the end of a leg by metres (radians, ...) at a state that it does not depend on.
_TARGET = [KNOBS.index("target x"), KNOBS.index("target y")]


class TargetSensitivity:
    """Simulates a leg in closed loop over the prediction model and differentiates it by its target."""

    def __init__(self, problem: OptimalControlProblem, solver: Solver, guide: LegGuide, congestion: Congestion) -> None:
        """Gives it what a controller has; the solver is that of `problem`, with a horizon of the problem's length."""
        self._recorder = LegRecorder(problem, solver, guide, congestion)
        self._analysis = SensitivityAnalysis(problem)
        self._loop = ClosedLoop(self._analysis, solver, SimulationModel(period=problem.period))

    def __call__(
        self,
        initial_state: ArrayLike,
        target: Pose,
        obstacles: Sequence[Shape],
        *,
        action: Action,
        carrying: bool,
        weights: Sequence[float],
        learned: LearnedDynamics = NOTHING_LEARNED,
    ) -> Vector:
        """D (x, y at the end) / d (x, y of the target), shape (2, 2), by the adjoint mode.

        Args:
            initial_state: z_0, shape (6,).
            target: the pose that the leg ends at.
            obstacles: what the sensor sees.
            action: that the leg is of.
            carrying: whether the gripper holds something.
            weights: the preferences.
            learned: the dynamics that are simulated, where any have been learned; else the nominal ones.

        Raises:
            RuntimeError: the simulated leg does not succeed, or its end has no derivative.
        """
        style, dynamics = style_of(action, carrying=carrying), learned_parameters(learned)
        leg = self._recorder.record(initial_state, target, obstacles, style=style, weights=weights, dynamics=dynamics)
        if not leg.steps:
            raise RuntimeError("was over before it began")
        model = leg.steps[0].dynamics.vector
        schedule = leg.with_knobs(NOMINAL, self._analysis.columns)
        run = self._loop.run(leg.initial_state, schedule, model, len(leg.steps))
        tail = run.tail
        if not tail.steps:
            raise RuntimeError("has no derivative at its end")
        gradients = [adjoint(tail, end) for end in np.eye(STATE_SIZE)[[StateIndex.X, StateIndex.Y]]]
        whole = len(tail.steps) == len(run.steps)
        if not whole and max(np.abs(gradient.by_initial_state).max() for gradient in gradients) > _FORGOTTEN:
            raise RuntimeError("has no derivative near its end")
        return np.array([gradient.by_knobs[_TARGET] for gradient in gradients])
