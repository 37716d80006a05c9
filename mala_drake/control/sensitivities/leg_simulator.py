"""A leg driven again in simulation, as the controller drove it, such that it can be differentiated."""

from __future__ import annotations

from collections.abc import Callable

from mala_drake.control.action_parameters import learned_style
from mala_drake.control.leg import LegGuide
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import learned_parameters
from mala_drake.control.solver import Solver
from mala_drake.control.weights_to_costs import learned_translation
from mala_drake.messages import DrivenLeg
from mala_drake.ward.congestion import Congestion

from .analysis import SensitivityAnalysis
from .closed_loop import ClosedLoop, ClosedLoopRun
from .columns import Columns
from .leg_parameters import LegParameters
from .recorded_leg import LegRecorder, RecordedLeg
from .simulation_model import SimulationModel

Schedule = Callable[[RecordedLeg, Columns], LegParameters]
"""The parameters of a recorded leg, with their derivatives by whatever it is to be differentiated by."""


class LegSimulator:
    """Simulates legs in closed loop over the prediction model: action, weights and model are those of the real leg."""

    def __init__(
        self,
        problem: OptimalControlProblem,
        solver: Solver,
        guide: LegGuide,
        congestion: Congestion,
        *,
        shortest_horizon: int | None = None,
    ) -> None:
        """Gives it what a controller has.

        Args:
            problem: of the controller.
            solver: of that problem, as the controller's but not the same one.
            guide: decides about legs.
            congestion: limits the speed by zone.
            shortest_horizon: if given, the horizon shrinks to the end of the leg, see `MpcController`.
        """
        analysis = SensitivityAnalysis(problem)
        self._columns = analysis.columns
        self._recorder = LegRecorder(problem, solver, guide, congestion, shortest_horizon=shortest_horizon)
        self._loop = ClosedLoop(analysis, solver, SimulationModel(period=problem.period))

    def __call__(self, driven: DrivenLeg, schedule: Schedule) -> ClosedLoopRun:
        """The leg from its initial state until the robot has stopped.

        Args:
            driven: the leg as it was.
            schedule: what the leg is to be differentiated by.

        Raises:
            RuntimeError: the simulated leg does not succeed.
        """
        leg = self._recorder.record(
            driven.initial_state,
            driven.target,
            driven.obstacles,
            style=learned_style(driven.action, driven.weights, carrying=driven.carrying),
            weights=driven.preferences,
            dynamics=learned_parameters(driven.dynamics),
            translation=learned_translation(driven.weights),
        )
        model = leg.steps[0].dynamics.vector
        return self._loop.run(leg.initial_state, schedule(leg, self._columns), model, len(leg.steps))
