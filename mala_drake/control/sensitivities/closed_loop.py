"""A leg simulated in closed loop over f*, with what is needed to differentiate it (paper, eq. sim)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control.solver import Solver
from mala_drake.messages import Message

from .analysis import SensitivityAnalysis
from .columns import INITIAL_STATE
from .leg_parameters import LegParameters
from .regularity import Regularity
from .simulation_model import SimulationModel, Transition

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class ClosedLoopStep(Message):
    """One step of the closed loop with its linearisation."""

    state: Vector  # z_i, shape (6,).
    control: Vector  # u_i, shape (3,).
    transition: Transition
    policy_by_state: Vector  # d pi / d z, shape (3, 6), with parameters that follow the state.
    policy_by_knobs: Vector  # d pi / d knobs, shape (3, m).
    regularity: Regularity
    solved: bool  # Whether the solver reached a local optimum.


@dataclass(frozen=True, slots=True, eq=False)
class ClosedLoopRun(Message):
    """A simulated leg of tau steps."""

    steps: tuple[ClosedLoopStep, ...]

    @property
    def states(self) -> Vector:
        """z_0 ... z_tau, shape (tau + 1, 6)."""
        return np.array([step.state for step in self.steps] + [self.steps[-1].transition.state])

    @property
    def controls(self) -> Vector:
        """u_0 ... u_{tau-1}, shape (tau, 3)."""
        return np.array([step.control for step in self.steps])

    @property
    def differentiable(self) -> bool:
        """Whether every solve reached a local optimum that has a derivative."""
        return all(step.solved and step.regularity.differentiable for step in self.steps)

    @property
    def tail(self) -> ClosedLoopRun:
        """The steps after the last one without a derivative; all of them where there is none."""
        broken = [i for i, step in enumerate(self.steps) if not (step.solved and step.regularity.differentiable)]
        return ClosedLoopRun(self.steps[broken[-1] + 1 :] if broken else self.steps)


class ClosedLoop:
    """Runs a leg over f* with converged solutions of an MPC."""

    def __init__(self, analysis: SensitivityAnalysis, solver: Solver, simulation: SimulationModel) -> None:
        """Closes the loop.

        Args:
            analysis: of the problem that `solver` solves.
            solver: finds the solutions that are then carried to the central path. If the parameters' horizon changes
                on the way it must take any, see `SolverByHorizon`.
            simulation: f*.
        """
        self._analysis = analysis
        self._solver = solver
        self._simulation = simulation

    def run(
        self, initial_state: ArrayLike, leg: LegParameters, model_parameters: ArrayLike, steps: int
    ) -> ClosedLoopRun:
        """Simulates `steps` steps from `initial_state`, shape (6,).

        Args:
            initial_state: z_0.
            leg: the parameters of each solve.
            model_parameters: of f*, (p^f, c).
            steps: tau, at least 1.
        """
        state, warm_start = np.array(initial_state, dtype=float), None
        done = []
        groups = (*leg.groups, INITIAL_STATE)
        for i in range(steps):
            chosen = leg.at(i, state)
            solution = self._solver.solve(state, chosen.parameters, warm_start)
            analysis = self._analysis.of_horizon(chosen.parameters.horizon)
            columns = analysis.columns
            point = analysis.polish(solution, state, chosen.parameters)
            policy = analysis.policy(point, groups)
            by_state = policy.jacobian[:, columns.slices[INITIAL_STATE]]
            by_parameters = policy.jacobian[:, columns.parameters]
            if chosen.by_state is not None:
                by_state = by_state + by_parameters @ chosen.by_state
            transition = self._simulation.step(state, policy.control, model_parameters)
            done.append(
                ClosedLoopStep(
                    state=state,
                    control=policy.control,
                    transition=transition,
                    policy_by_state=by_state,
                    policy_by_knobs=by_parameters @ chosen.by_knobs,
                    regularity=policy.regularity,
                    solved=solution.success,
                )
            )
            state, warm_start = transition.state, solution.shifted()
        return ClosedLoopRun(tuple(done))
