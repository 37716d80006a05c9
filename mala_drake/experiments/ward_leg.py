"""A leg of the ward as the controller drives it, recorded so that it can be driven again with other targets and costs.

The references of a leg follow the robot by rules that are not smooth (the nearest sample of the path, turns on the
spot). Recorded, they are a schedule by time: what is left between its numbers and the end of the leg is differentiable.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control import MpcParameters, OptimalControlProblem, Solver
from mala_drake.control.action_parameters import EMPTY_HANDED, make_parameters
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.model import STATE_SIZE, StateIndex
from mala_drake.control.reference import make_reference
from mala_drake.control.sensitivities import Columns, ScheduledParameters, StepParameters
from mala_drake.messages import Outcome
from mala_drake.preferences import CRITERIA
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.ward_map import Ward

Vector = NDArray[np.float64]

KNOBS = ("target x", "target y", "position weight", "control weight")
"""What moves a recorded leg: the target's displacement, metres, which drags the path along; factors on Q and R."""

NOMINAL = (0.0, 0.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class WardLeg:
    """A recorded leg of tau steps."""

    initial_state: Vector  # Shape (6,).
    steps: tuple[MpcParameters, ...]
    shares: tuple[Vector, ...]  # Of the path behind each reference z_0 ... z_N, from 0 to 1, shape (N + 1,).

    def with_knobs(self, knobs: ArrayLike, columns: Columns) -> ScheduledParameters:
        """The leg's parameters for values of `KNOBS`, with their derivatives."""
        values = np.asarray(knobs, dtype=float)
        steps = [_step(*pair, values, columns) for pair in zip(self.steps, self.shares, strict=True)]
        return ScheduledParameters(steps, ("terminal", "stage"))


def record_leg(problem: OptimalControlProblem, solver: Solver, ward: Ward, start: str, goal: str) -> WardLeg:
    """Drives from place to place over the prediction model, as the controller does, until the robot has stopped.

    Raises:
        RuntimeError: the leg did not succeed.
    """
    congestion = Congestion(ward)
    guide = LegGuide(leg_planner(ward), congestion, ward.shapes, LegRules())
    places = ward.place
    first = np.array([places[start].x, places[start].y, places[start].yaw, 0.0, 0.0, 0.0])
    state, warm_start = first, None
    leg = guide.begin((places[goal].x, places[goal].y, places[goal].yaw), state, ())
    steps, shares = [], []
    while leg.outcome is Outcome.RUNNING and leg.track is not None:
        track = leg.track
        reference = make_reference(
            track, state, leg.length, turning=leg.turning, horizon=problem.horizon, period=problem.period
        )
        parameters = make_parameters(
            style=EMPTY_HANDED,
            weights=(1 / len(CRITERIA),) * len(CRITERIA),
            reference=reference,
            obstacles=ward.shapes,
            congestion=congestion,
        )
        solution = solver.solve(state, parameters, warm_start)
        steps.append(parameters)
        positions = reference.states[:, [StateIndex.X, StateIndex.Y]]
        reached = [track.progress(position, leg.length)[0] for position in positions]
        shares.append(np.array(reached) / track.path.length)
        state = problem.step(state, solution.controls[0], parameters.dynamics.vector).full()[:, 0]
        warm_start = solution.shifted()
        leg = guide.advance(leg, state, ())
    if leg.outcome is not Outcome.SUCCESS:
        raise RuntimeError(f"the leg from {start} to {goal} ended as {leg.outcome.value}: {leg.detail}")
    return WardLeg(first, tuple(steps), tuple(shares))


def _step(parameters: MpcParameters, shares: Vector, knobs: Vector, columns: Columns) -> StepParameters:
    terminal, stage = parameters.terminal, parameters.stage
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
