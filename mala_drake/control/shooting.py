"""The optimal control problem as expressions of the controls alone: single shooting.

Every later derivative (gradient, Hessian, sensitivity with respect to p) is taken from these expressions, so that the
problem is stated in one place.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi

from . import model
from .layout import ParameterLayout
from .model import ControlIndex, StateIndex
from .obstacles import signed_distance
from .penalty import hinge_slope, huberised_hinge

OBSTACLE_BUFFER = 0.04
"""Metres beyond the required distance over which the obstacle penalty builds up."""

LIMIT_BUFFER = 0.05
"""m/s, rad/s or m/s^2 inside a path limit over which its penalty builds up."""

LIMITS = ("speed", "reverse", "yaw_rate_left", "yaw_rate_right", "lateral_left", "lateral_right")
"""Order of the path limits of one stage."""


@dataclass(frozen=True)
class ShootingExpressions:
    """Symbols and expressions of the problem with N stages and M obstacle slots.

    Attributes:
        controls: U, symbol of shape (3, N), one column a stage.
        initial_state: z_0, symbol of shape (6, 1).
        parameters: p, symbol in the order of `ParameterLayout`.
        states: Z = (z_0 ... z_N), shape (6, N + 1).
        cost: the total cost with penalties, scalar.
        obstacle_margins: distance less required distance at stages 1 ... N, shape (M, N), metres.
        limit_margins: distance to each path limit at stages 1 ... N, shape (6, N), in the order of `LIMITS`.
    """

    controls: casadi.SX
    initial_state: casadi.SX
    parameters: casadi.SX
    states: casadi.SX
    cost: casadi.SX
    obstacle_margins: casadi.SX
    limit_margins: casadi.SX
    obstacle_multipliers: casadi.SX
    limit_multipliers: casadi.SX


def build_expressions(layout: ParameterLayout, period: float) -> ShootingExpressions:
    """States the problem for `layout` with a control period of `period` seconds."""
    controls = casadi.SX.sym("controls", model.CONTROL_SIZE, layout.horizon)
    initial_state = casadi.SX.sym("initial_state", model.STATE_SIZE)
    parameters = casadi.SX.sym("parameters", layout.size)
    pieces = parameter_pieces(layout, parameters)

    columns = [initial_state]
    for k in range(layout.horizon):
        columns.append(model.step(columns[k], controls[:, k], pieces["dynamics"], period))
    reached = columns[1:]

    to_obstacles = casadi.horzcat(*(obstacle_margins(state, pieces) for state in reached))
    to_limits = casadi.horzcat(*(limit_margins(state, k, pieces) for k, state in enumerate(reached)))
    obstacle_penalty, limit_penalty = pieces["constraints.obstacle_penalty"], pieces["constraints.limit_penalty"]
    cost = (
        _tracking_cost(columns, controls, pieces)
        + obstacle_penalty * margin_penalty(to_obstacles, OBSTACLE_BUFFER)
        + limit_penalty * margin_penalty(to_limits, LIMIT_BUFFER)
        + pieces["constraints.reverse_braking_penalty"] * reverse_braking(reached, controls)
    )
    return ShootingExpressions(
        controls=controls,
        initial_state=initial_state,
        parameters=parameters,
        states=casadi.horzcat(*columns),
        cost=cost,
        obstacle_margins=to_obstacles,
        limit_margins=to_limits,
        obstacle_multipliers=obstacle_penalty * hinge_slope(OBSTACLE_BUFFER - to_obstacles, OBSTACLE_BUFFER),
        limit_multipliers=limit_penalty * hinge_slope(LIMIT_BUFFER - to_limits, LIMIT_BUFFER),
    )


def parameter_pieces(layout: ParameterLayout, parameters: casadi.SX) -> dict[str, casadi.SX]:
    """The pieces of the symbol p by name, matrices in their shapes."""
    return layout.split(parameters, _reshape_rows)


def _tracking_cost(columns: list[casadi.SX], controls: casadi.SX, pieces: dict[str, Any]) -> casadi.SX:
    """The quadratic stage costs and the terminal cost."""
    cost = weighted_square(columns[-1] - pieces["terminal.target"], pieces["terminal.weights"])
    for k, state in enumerate(columns[:-1]):
        error = state - pieces["stage.references"][k, :].T
        cost += weighted_square(error, pieces["stage.state_weights"])
        cost += weighted_square(controls[:, k], pieces["stage.control_weights"])
    return cost


def obstacle_margins(state: casadi.SX, pieces: dict[str, Any]) -> casadi.SX:
    """Distance less required distance to every obstacle slot, shape (M, 1), metres."""
    obstacles, required = pieces["constraints.obstacles"], pieces["constraints.required_distance"]
    x, y = state[StateIndex.X], state[StateIndex.Y]
    rows = (obstacles[m, :] for m in range(obstacles.shape[0]))
    return casadi.vertcat(*(signed_distance(x, y, row) - required for row in rows))


def limit_margins(state: casadi.SX, stage: int, pieces: dict[str, Any]) -> casadi.SX:
    """Distances to the path limits in the order of `LIMITS`, shape (6, 1), after stage `stage`."""
    forward, yaw_rate = state[StateIndex.FORWARD_VELOCITY], state[StateIndex.YAW_RATE]
    yaw_rate_limit, lateral_limit = pieces["constraints.yaw_rate_limit"], pieces["constraints.lateral_limit"]
    return casadi.vertcat(
        pieces["constraints.speed_limits"][stage] - forward,
        pieces["constraints.reverse_limit"] + forward,
        yaw_rate_limit - yaw_rate,
        yaw_rate_limit + yaw_rate,
        lateral_limit - forward * yaw_rate,
        lateral_limit + forward * yaw_rate,
    )


def reverse_braking(reached: list[casadi.SX], controls: casadi.SX) -> casadi.SX:
    """What it costs to brake into reverse.

    A real brake stops the robot and no more, while the smooth model would let it push backward. Braking is free while
    the stage ends forward and costs its size times the backward speed otherwise: reversing is propulsion's work.
    """
    backward = (huberised_hinge(-state[StateIndex.FORWARD_VELOCITY], LIMIT_BUFFER) for state in reached)
    return sum(controls[ControlIndex.BRAKE, k] * speed for k, speed in enumerate(backward))


def margin_penalty(margins: casadi.SX, buffer: float) -> casadi.SX:
    """The sum of the penalties of `margins`, per unit of slope."""
    return casadi.sum(casadi.vec(huberised_hinge(buffer - margins, buffer)))


def weighted_square(error: casadi.SX, weights: casadi.SX) -> casadi.SX:
    """The quadratic cost e' diag(weights) e."""
    return casadi.dot(weights, error * error)


def _reshape_rows(piece: casadi.SX, shape: tuple[int, ...]) -> casadi.SX:
    """CasADi stores columns; the layout stores rows."""
    return casadi.reshape(piece, shape[1], shape[0]).T if len(shape) == 2 else piece
