"""A leg as the controller drives it, recorded so that it can be driven again with other targets and costs.

The references of a leg follow the robot by rules that are not smooth (the nearest sample of the path, turns on the
spot), and so does a horizon that shrinks. Recorded, they are a schedule by time: what is left between its numbers and
the end of the leg is differentiable.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control.action_parameters import DrivingStyle, make_parameters
from mala_drake.control.leg import LegGuide, Pose
from mala_drake.control.model import STATE_SIZE, StateIndex
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import DynamicsParameters, MpcParameters
from mala_drake.control.solver import Solver
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.messages import Outcome, Shape
from mala_drake.ward.congestion import Congestion

from .columns import Columns
from .leg_parameters import ScheduledParameters, StepParameters

Vector = NDArray[np.float64]

KNOBS = ("target x", "target y", "position weight", "control weight")
"""What moves a recorded leg: the target's displacement, metres, which drags the path along; factors on Q and R."""

NOMINAL = (0.0, 0.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class RecordedLeg:
    """A recorded leg of tau steps."""

    initial_state: Vector  # Shape (6,).
    steps: tuple[MpcParameters, ...]
    shares: tuple[Vector, ...]  # Of the path behind each reference z_0 ... z_N, from 0 to 1, shape (N + 1,).

    def with_knobs(self, knobs: ArrayLike, columns: Columns) -> ScheduledParameters:
        """The leg's parameters for values of `KNOBS`, with their derivatives; `columns` are the problem's."""
        values = np.asarray(knobs, dtype=float)
        steps = [_step(*pair, values, columns) for pair in zip(self.steps, self.shares, strict=True)]
        return ScheduledParameters(steps, ("terminal", "stage"))


class LegRecorder:
    """Drives legs over the prediction model, as the controller does, until the robot has stopped."""

    def __init__(
        self,
        problem: OptimalControlProblem,
        solver: Solver,
        guide: LegGuide,
        congestion: Congestion,
        *,
        shortest_horizon: int | None = None,
    ) -> None:
        """Gives the recorder what a controller has; see `MpcController`. The solver is that of `problem`."""
        self._problem = problem
        self._solver = solver
        self._guide = guide
        self._congestion = congestion
        self._shortest_horizon = shortest_horizon

    def record(
        self,
        initial_state: ArrayLike,
        target: Pose,
        obstacles: Sequence[Shape],
        *,
        style: DrivingStyle,
        weights: Sequence[float],
        dynamics: DynamicsParameters | None = None,
        translation: CostTranslation = DEFAULT_TRANSLATION,
    ) -> RecordedLeg:
        """The leg from a state, shape (6,), to a pose.

        Args:
            initial_state: z_0.
            target: the pose to stop at.
            obstacles: what the sensor sees all along.
            style: of driving.
            weights: the preferences.
            dynamics: p^f of the model that is driven over; nominal if None.
            translation: from the preferences to Q and R.

        Raises:
            RuntimeError: the leg did not succeed; says how it ended.
        """
        first = np.array(initial_state, dtype=float)
        state, warm_start = first, None
        leg = self._guide.begin(target, state, obstacles)
        steps: list[MpcParameters] = []
        shares: list[Vector] = []
        while leg.outcome is Outcome.RUNNING and leg.track is not None:
            track = leg.track
            reference = leg.reference(state, self._problem, self._shortest_horizon)
            parameters = make_parameters(
                style=style,
                weights=weights,
                reference=reference,
                obstacles=obstacles,
                congestion=self._congestion,
                dynamics=dynamics,
                translation=translation,
            )
            solution = self._solver.solve(state, parameters, warm_start)
            if not solution.usable:
                raise RuntimeError(f"ended as {Outcome.SOLVER_FAILURE.value}: a solve ended as {solution.status.value}")
            steps.append(parameters)
            positions = reference.states[:, [StateIndex.X, StateIndex.Y]]
            reached = [track.progress(position, leg.length)[0] for position in positions]
            shares.append(np.array(reached) / track.path.length)
            state = self._problem.step(state, solution.controls[0], parameters.dynamics.vector).full()[:, 0]
            warm_start = solution.shifted()
            leg = self._guide.advance(leg, state, obstacles)
        if leg.outcome is not Outcome.SUCCESS:
            raise RuntimeError(f"ended as {leg.outcome.value}: {leg.detail}")
        return RecordedLeg(first, tuple(steps), tuple(shares))


def _step(parameters: MpcParameters, shares: Vector, knobs: Vector, columns: Columns) -> StepParameters:
    terminal, stage = parameters.terminal, parameters.stage
    columns = columns.of_horizon(parameters.horizon)
    offset = np.zeros(STATE_SIZE)
    offset[[StateIndex.X, StateIndex.Y]] = knobs[:2]
    position = np.zeros(STATE_SIZE)
    position[[StateIndex.X, StateIndex.Y]] = 1.0
    factors = 1.0 + position * (knobs[2] - 1.0)
    moved = replace(
        parameters,
        terminal=replace(terminal, target=terminal.target + shares[-1] * offset, weights=terminal.weights * factors),
        stage=replace(
            stage,
            references=stage.references + shares[:-1, None] * offset,
            state_weights=stage.state_weights * factors,
            control_weights=stage.control_weights * knobs[3],
        ),
    )
    by_knobs = np.zeros((columns.parameters.stop, len(KNOBS)))
    directions = np.eye(STATE_SIZE)[:, [StateIndex.X, StateIndex.Y]]
    by_knobs[columns.of(["terminal.target"]), :2] = shares[-1] * directions
    by_knobs[columns.of(["stage.references"]), :2] = np.kron(shares[:-1, None], directions)
    by_knobs[columns.of(["terminal.weights"]), 2] = terminal.weights * position
    by_knobs[columns.of(["stage.state_weights"]), 2] = stage.state_weights * position
    by_knobs[columns.of(["stage.control_weights"]), 3] = stage.control_weights
    return StepParameters(moved, by_knobs)
