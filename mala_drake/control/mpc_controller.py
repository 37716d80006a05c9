"""The layer that moves the robot: one optimal control problem a tick, selected by the planned action."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from mala_drake.clock import CONTROL_OFFSET, TICK
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    MagnetCommand,
    Message,
    Obstacles,
    Outcome,
    PredictedTrajectory,
    Preferences,
)
from mala_drake.optional_input import told
from mala_drake.ward.congestion import Congestion

from .action_parameters import DrivingStyle, learned_style, make_parameters
from .leg import Leg, LegGuide, Pose, pose_errors
from .model import CONTROL_SIZE, STATE_SIZE, StateIndex
from .optimal_control_problem import OptimalControlProblem
from .parameters import DynamicsParameters, TerminalParameters, learned_parameters
from .solution import Solution
from .solver import Solver
from .tracking_cost import stage_cost, terminal_cost
from .weights_to_costs import DEFAULT_TRANSLATION, CostTranslation, learned_translation

PARKED = (0.0, 2.0, 0.0)
"""The control that stands still: no propulsion, full (passive) brake."""


@dataclass(frozen=True, slots=True, eq=False)
class _Driving(Message):
    """The controller's state: the action it drives for, and how far it is."""

    action: Action = Action()
    style: DrivingStyle = DrivingStyle()
    translation: CostTranslation = DEFAULT_TRANSLATION
    leg: Leg | None = None
    control: tuple[float, ...] = PARKED
    warm_start: NDArray[np.float64] | None = None
    report: ActionReport = ActionReport()
    predicted: PredictedTrajectory = PredictedTrajectory()  # Empty while the robot is parked.
    terminal: TerminalParameters | None = None  # Of the newest solve.
    bad_solves: int = 0  # In a row.
    bad_states: int = 0  # In a row.


class MpcController(LeafSystem):
    """Drives legs: each tick solves the optimal control problem that the planned action selects.

    .. pydrake_system::

        name: MpcController
        input_ports:
        - robot_state
        - action
        - obstacles
        - preferences
        - charge
        - magnet
        - learned_targets
        - learned_dynamics
        - learned_weights
        output_ports:
        - control
        - leg_report
        - predicted_trajectory

    A new action (a higher sequence number) replaces the one under way; one that is not a movement parks the robot.
    A leg ends where `learned_targets` says at its beginning, if that is connected and says so, else where the map does.
    Whatever goes wrong - no free way, failed solves, a state that is not finite, an empty battery - the robot brakes
    and the report says what happened. A solve that has stopped at its iteration limit, as every one may that is a
    real-time iteration, is no failure: the robot drives on with its controls.

    The model it predicts with, p^f, is what `learned_dynamics` says; where that says nothing or is not connected, it is
    the nominal one. What costs it, p^g and the translation of the preferences, is what `learned_weights` says when a
    leg begins; where that says nothing or is not connected, the kind of action and the preferences alone decide.

    The wall time of each solve is appended to `solve_seconds`, a plain list: it depends on the machine, so it is no
    part of the diagram's state, and nothing in the diagram reads it.
    """

    def __init__(
        self,
        *,
        targets: Mapping[str, Pose],
        guide: LegGuide,
        congestion: Congestion,
        problem: OptimalControlProblem,
        solver: Solver,
        shortest_horizon: int | None = None,
    ) -> None:
        """Makes the controller.

        Args:
            targets: place name to the pose (x, y, yaw) to stop at, metres and radians.
            guide: decides about legs.
            congestion: limits the speed by zone.
            problem: the optimal control problem that `solver` solves.
            solver: owned by this system.
            shortest_horizon: if given, the horizon shrinks to the end of the leg, but to no fewer stages; the solver
                must then take any horizon, see `SolverByHorizon`. If None it always has the problem's length.
        """
        super().__init__()
        self._targets = dict(targets)
        self._guide = guide
        self._congestion = congestion
        self._problem = problem
        self._solver = solver
        self._shortest_horizon = shortest_horizon
        self.solve_seconds: list[float] = []
        self._robot_state = self.DeclareVectorInputPort("robot_state", STATE_SIZE)
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._obstacles = self.DeclareAbstractInputPort("obstacles", Value(Obstacles()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._charge = self.DeclareVectorInputPort("charge", 1)
        self._magnet = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._learned_targets = self.DeclareAbstractInputPort("learned_targets", Value(LearnedTargets()))
        self._learned_dynamics = self.DeclareAbstractInputPort("learned_dynamics", Value(LearnedDynamics()))
        self._learned_weights = self.DeclareAbstractInputPort("learned_weights", Value(LearnedWeights()))
        self._driving = self.DeclareAbstractState(Value(_Driving()))
        from_state = {self.abstract_state_ticket(self._driving)}
        self.DeclareVectorOutputPort("control", CONTROL_SIZE, self._calc_control, prerequisites_of_calc=from_state)
        self.DeclareAbstractOutputPort(
            "leg_report",
            lambda: Value(ActionReport()),
            self._calc_leg_report,
            prerequisites_of_calc=from_state,
        )
        self.DeclareAbstractOutputPort(
            "predicted_trajectory",
            lambda: Value(PredictedTrajectory()),
            self._calc_predicted_trajectory,
            prerequisites_of_calc=from_state,
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, CONTROL_OFFSET, self._update)

    def _calc_control(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._state(context).control)

    def _calc_leg_report(self, context: Context, output: Value) -> None:
        output.set_value(self._state(context).report)

    def _calc_predicted_trajectory(self, context: Context, output: Value) -> None:
        output.set_value(self._state(context).predicted)

    def _state(self, context: Context) -> _Driving:
        return context.get_abstract_state(self._driving).get_value()

    def _update(self, context: Context, state: State) -> None:
        driving = before = self._state(context)
        action = self._action.Eval(context)
        if action.sequence > driving.action.sequence:
            driving = self._accept(context, action)
        if driving.report.sequence and not driving.report.finished:
            driving = self._drive(context, driving, np.array(self._robot_state.Eval(context)))
        if driving is not before:
            state.get_mutable_abstract_state(self._driving).set_value(driving)

    def _accept(self, context: Context, action: Action) -> _Driving:
        learned = told(self._learned_weights, context, LearnedWeights())
        driving = _Driving(
            action=action,
            style=learned_style(action, learned, carrying=bool(self._magnet.Eval(context).held)),
            translation=learned_translation(learned),
        )
        if action.kind is not ActionKind.MOVE:
            return driving
        return replace(driving, report=ActionReport(sequence=action.sequence))

    def _drive(self, context: Context, driving: _Driving, robot_state: NDArray[np.float64]) -> _Driving:
        """One control step of a leg under way."""
        if not np.isfinite(robot_state).all():
            return self._without_state(driving)
        if not self._charge.Eval(context)[0] > 0:
            return self._finish(driving, robot_state, Outcome.BATTERY_EMPTY, "no charge left")
        seen = self._obstacles.Eval(context).shapes
        if driving.leg is None:
            target = self._target(context, driving.action.place)
            if target is None:
                return self._finish(driving, robot_state, Outcome.BLOCKED, f"no place {driving.action.place!r}")
            leg = self._guide.begin(target, robot_state, seen)
        else:
            leg = self._guide.advance(driving.leg, robot_state, seen)
        driving = replace(driving, leg=leg, bad_states=0)
        if leg.outcome is not Outcome.RUNNING or leg.track is None:
            return self._finish(driving, robot_state, leg.outcome, leg.detail)
        return self._solve(context, driving, leg, robot_state)

    def _target(self, context: Context, place: str) -> Pose | None:
        """Where the robot is to stop for a place: p^w of the action that leads there."""
        pose = self._targets.get(place)
        return None if pose is None else told(self._learned_targets, context, LearnedTargets()).pose(place, pose)

    def _solve(self, context: Context, driving: _Driving, leg: Leg, robot_state: NDArray[np.float64]) -> _Driving:
        parameters = make_parameters(
            style=driving.style,
            weights=self._preferences.Eval(context).estimate,
            reference=leg.reference(robot_state, self._problem, self._shortest_horizon),
            obstacles=self._obstacles.Eval(context).shapes,
            congestion=self._congestion,
            dynamics=self._dynamics(context),
            translation=driving.translation,
        )
        started = time.perf_counter()
        solution = self._solver.solve(robot_state, parameters, driving.warm_start)
        self.solve_seconds.append(time.perf_counter() - started)
        usable = solution.usable
        step_cost = stage_cost(robot_state, solution.controls[0], parameters.stage) if usable else 0.0
        report = replace(
            driving.report,
            steps=leg.steps,
            solves=driving.report.solves + 1,
            failures=driving.report.failures + (not usable),
            not_converged=driving.report.not_converged + (usable and not solution.success),
            closed_loop_cost=driving.report.closed_loop_cost + step_cost,
        )
        if not usable:
            return self._after_failed_solve(replace(driving, report=report), robot_state, solution)
        return replace(
            driving,
            control=tuple(solution.controls[0].tolist()),
            warm_start=solution.shifted(),
            predicted=PredictedTrajectory(tuple(map(tuple, solution.states.tolist()))),
            terminal=parameters.terminal,
            report=report,
            bad_solves=0,
        )

    def _dynamics(self, context: Context) -> DynamicsParameters | None:
        """p^f as learned, or None for the nominal one."""
        return learned_parameters(told(self._learned_dynamics, context, LearnedDynamics()))

    def _after_failed_solve(self, driving: _Driving, robot_state: NDArray[np.float64], solution: Solution) -> _Driving:
        """Brakes, and tries again from a cold start at the next tick; reports when that keeps failing."""
        bad_solves = driving.bad_solves + 1
        driving = _parked(replace(driving, bad_solves=bad_solves))
        if bad_solves > self._guide.rules.tolerated_failures:
            detail = f"{bad_solves} solves in a row ended as {solution.status.value}"
            return self._finish(driving, robot_state, Outcome.SOLVER_FAILURE, detail)
        return driving

    def _without_state(self, driving: _Driving) -> _Driving:
        """Brakes while the state estimate is not finite; reports when it stays so."""
        bad_states = driving.bad_states + 1
        driving = _parked(replace(driving, bad_states=bad_states))
        if bad_states <= self._guide.rules.tolerated_failures:
            return driving
        report = replace(
            driving.report, outcome=Outcome.INVALID_STATE, detail=f"state not finite {bad_states} times in a row"
        )
        return replace(driving, report=report)

    def _finish(self, driving: _Driving, robot_state: NDArray[np.float64], outcome: Outcome, detail: str) -> _Driving:
        target = driving.leg.target if driving.leg else self._targets.get(driving.action.place)
        position_error, yaw_error = pose_errors(robot_state, target) if target else (None, None)
        end_cost = terminal_cost(robot_state, target, driving.terminal) if target and driving.terminal else 0.0
        report = replace(
            driving.report,
            outcome=outcome,
            steps=driving.leg.steps if driving.leg else 0,
            position_error=position_error,
            yaw_error=yaw_error,
            terminal_speed=abs(float(robot_state[StateIndex.FORWARD_VELOCITY])),
            closed_loop_cost=driving.report.closed_loop_cost + end_cost,
            detail=detail,
        )
        return _parked(replace(driving, report=report))


def _parked(driving: _Driving) -> _Driving:
    """The robot stands; nothing is predicted, and the next solve starts cold."""
    return replace(driving, control=PARKED, warm_start=None, predicted=PredictedTrajectory())
