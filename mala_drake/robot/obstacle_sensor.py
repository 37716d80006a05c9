"""The obstacle sensor: the only way in which the robot learns of what is not on its map."""

from __future__ import annotations

import math
from collections.abc import Iterable

from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem

from mala_drake.errors import BadInput
from mala_drake.messages import Obstacles, Shape
from mala_drake.robot.line_of_sight import LineOfSight

RANGE = 6.0
"""Metres within which the sensor sees."""


class ObstacleSensor(LeafSystem):
    """Sees the solid shapes around the robot that nothing hides, mapped or not.

    .. pydrake_system::

        name: ObstacleSensor
        input_ports:
        - robot_state
        output_ports:
        - obstacles

    It looks all round from the robot's position (the first two entries of `robot_state`). The same shapes in sight are
    the same `Obstacles` object, so that a receiver can compare by identity. Where the state is not finite, nothing is
    seen.
    """

    def __init__(self, *, mapped: Iterable[Shape], unmapped: Iterable[Shape] = (), reach: float = RANGE) -> None:
        """Constructs the sensor.

        Args:
            mapped: shapes that are on the robot's map.
            unmapped: shapes that are not.
            reach: of the sensor, metres.

        Raises:
            BadInput: if the reach is not positive and finite.
        """
        super().__init__()
        if not (reach > 0.0 and math.isfinite(reach)):
            raise BadInput("obstacle sensor reach", repr(reach), "metres above 0")
        self._shapes = (*mapped, *unmapped)
        self._line_of_sight = LineOfSight(self._shapes, reach=reach)
        # One message for each set of shapes that was ever in sight: a pure function's memory, not state.
        self._messages: dict[bytes, Obstacles] = {}
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self.DeclareAbstractOutputPort(
            "obstacles",
            lambda: Value(Obstacles()),
            self._calc_obstacles,
            prerequisites_of_calc={self._robot_state.ticket()},
        )

    def _calc_obstacles(self, context: Context, output: Value) -> None:
        x, y = self._robot_state.Eval(context)[:2]
        output.set_value(self._look(float(x), float(y)) if math.isfinite(x + y) else Obstacles())

    def _look(self, x: float, y: float) -> Obstacles:
        seen = self._line_of_sight.visible(x, y)
        key = seen.tobytes()
        if key not in self._messages:
            shapes = tuple(shape for shape, is_seen in zip(self._shapes, seen.tolist(), strict=True) if is_seen)
            self._messages[key] = Obstacles(shapes)
        return self._messages[key]
