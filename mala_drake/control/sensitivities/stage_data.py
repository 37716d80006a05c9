"""The parameters one stage of the problem sees, as a selection of entries of the parameter vector p.

Stage k is the control u_k, the transition to z_{k+1} and what both cost. Every number it depends on is an entry of p,
so that derivatives with respect to stage data become derivatives with respect to p where they are added up.
"""

from __future__ import annotations

from functools import cached_property

import casadi
import numpy as np
from numpy.typing import NDArray

from mala_drake.control.layout import ParameterLayout
from mala_drake.control.model import CONTROL_SIZE, DYNAMICS_SIZE, STATE_SIZE
from mala_drake.control.obstacles import OBSTACLE_SIZE

WEIGHTS, TARGET = "weights", "target"
"""Of the tracking cost of z_{k+1}: those of the next stage, or the terminal ones at the last stage."""

_SCALARS = (
    "constraints.reverse_limit",
    "constraints.yaw_rate_limit",
    "constraints.lateral_limit",
    "constraints.required_distance",
    "constraints.obstacle_penalty",
    "constraints.limit_penalty",
    "constraints.reverse_braking_penalty",
)


class StageData:
    """The layout of a stage's data for a problem with `layout`.

    Attributes:
        slices: name to place in the data of one stage. Names are those of `ParameterLayout`, `WEIGHTS` and `TARGET`.
        size: numbers a stage.
    """

    def __init__(self, layout: ParameterLayout) -> None:
        self._layout = layout
        sizes = {
            WEIGHTS: STATE_SIZE,
            TARGET: STATE_SIZE,
            "stage.control_weights": CONTROL_SIZE,
            "dynamics": DYNAMICS_SIZE,
            "constraints.speed_limits": 1,
            **dict.fromkeys(_SCALARS, 1),
            "constraints.obstacles": layout.slots * OBSTACLE_SIZE,
        }
        ends = np.cumsum(list(sizes.values()))
        starts = ends - list(sizes.values())
        self.slices = {name: slice(int(a), int(b)) for name, a, b in zip(sizes, starts, ends, strict=True)}
        self.size = int(ends[-1])

    @cached_property
    def sources(self) -> NDArray[np.intp]:
        """Where the data come from, shape (N, size): stage k's are p[sources[k]]."""
        places = {name: np.arange(place.start, place.stop) for name, place in self._layout.slices.items()}
        horizon = self._layout.horizon
        sources = np.zeros((horizon, self.size), dtype=np.intp)
        by_stage = {"constraints.speed_limits": places["constraints.speed_limits"][:, None]}
        for name in set(self.slices) & set(places):
            sources[:, self.slices[name]] = by_stage.get(name, places[name])
        references = places["stage.references"].reshape(horizon, STATE_SIZE)
        sources[:, self.slices[TARGET]] = np.vstack((references[1:], places["terminal.target"]))
        sources[:-1, self.slices[WEIGHTS]] = places["stage.state_weights"]
        sources[-1, self.slices[WEIGHTS]] = places["terminal.weights"]
        return sources

    def pieces(self, data: casadi.SX) -> dict[str, casadi.SX]:
        """The pieces of one stage's data by name, obstacles in their shape (M, 7), stored row by row."""
        pieces = {name: data[place] for name, place in self.slices.items()}
        obstacles = casadi.reshape(pieces["constraints.obstacles"], OBSTACLE_SIZE, self._layout.slots).T
        return {**pieces, "constraints.obstacles": obstacles}
