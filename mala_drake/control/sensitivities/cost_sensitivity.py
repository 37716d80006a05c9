"""How the cost of a leg moves with the weights that it is driven with: what p^g is learned through."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control.action_parameters import learned_style
from mala_drake.control.leg import LegGuide, Pose
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import learned_parameters
from mala_drake.control.solver import Solver
from mala_drake.control.weights_to_costs import learned_translation
from mala_drake.messages import Action, LearnedDynamics, LearnedWeights, Shape
from mala_drake.ward.congestion import Congestion

from .analysis import SensitivityAnalysis
from .closed_loop import ClosedLoop
from .leg_cost import LegCost
from .leg_sensitivity import adjoint
from .recorded_leg import LegRecorder
from .simulation_model import SimulationModel
from .weight_schedule import WEIGHT_KNOBS, weight_schedule

Vector = NDArray[np.float64]

_SHARE = 0.5  # Of a leg that must have derivatives, without a break, up to its end.


class CostSensitivity:
    """Simulates a leg in closed loop over the prediction model and differentiates its cost by the weights.

    The references are those recorded when the leg was driven with the present weights; they do not follow the robot
    when the weights change, as the controller's do. So delays are made up for in the simulation that add up in a real
    leg, and the gradient is one of direction more than of size.
    """

    def __init__(
        self,
        problem: OptimalControlProblem,
        solver: Solver,
        guide: LegGuide,
        congestion: Congestion,
        *,
        cost: LegCost,
        bedsides: Collection[str],
    ) -> None:
        """Gives it what a controller has.

        Args:
            problem: of the controller.
            solver: of that problem, with a horizon of the problem's length.
            guide: decides about legs.
            congestion: limits the speed by zone.
            cost: of a leg.
            bedsides: places to which legs have an approach error.
        """
        self._recorder = LegRecorder(problem, solver, guide, congestion)
        self._analysis = SensitivityAnalysis(problem)
        self._loop = ClosedLoop(self._analysis, solver, SimulationModel(period=problem.period))
        self._cost = cost
        self._bedsides = frozenset(bedsides)

    def __call__(
        self,
        initial_state: ArrayLike,
        target: Pose,
        obstacles: Sequence[Shape],
        *,
        action: Action,
        carrying: bool,
        weights: Sequence[float],
        prices: Sequence[float],
        learned: LearnedWeights,
        dynamics: LearnedDynamics,
    ) -> Vector:
        """D cost / d log of the diagonal entries of Q (with W's) and R, shape (9,), by the adjoint mode.

        The part of the leg after the last step without a derivative counts, if that is half of it or more.

        Args:
            initial_state: z_0, shape (6,).
            target: the pose that the leg ends at.
            obstacles: what the sensor sees.
            action: that the leg is of.
            carrying: whether the gripper holds something.
            weights: the preferences that the controller drives by.
            prices: of the five features, see `LegCost`.
            learned: the weights that the leg is driven with.
            dynamics: the model that is driven over, where any has been learned.

        Raises:
            RuntimeError: the simulated leg does not succeed, or its cost has no derivative.
        """
        leg = self._recorder.record(
            initial_state,
            target,
            obstacles,
            style=learned_style(action, learned, carrying=carrying),
            weights=weights,
            dynamics=learned_parameters(dynamics),
            translation=learned_translation(learned),
        )
        if not leg.steps:
            raise RuntimeError("was over before it began")
        schedule = weight_schedule(leg, np.zeros(WEIGHT_KNOBS), self._analysis.columns)
        run = self._loop.run(leg.initial_state, schedule, leg.steps[0].dynamics.vector, len(leg.steps)).tail
        if len(run.steps) < _SHARE * len(leg.steps):
            raise RuntimeError(f"has no derivative in the {len(leg.steps) - len(run.steps)} first of {len(leg.steps)}")
        own = np.array(prices) * [1.0, 1.0, 1.0, 1.0, float(action.place in self._bedsides)]
        cost = self._cost(run.states, run.controls, target, own)
        return adjoint(run, cost.by_end, cost.by_states, cost.by_controls).by_knobs
