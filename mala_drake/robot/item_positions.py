"""Where the boxes are: their centres out of the plant's state."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from mala_drake.robot.items import ItemBodies

_QUATERNION = 4  # Positions of a floating body before its translation.


class ItemPositions(LeafSystem):
    """Picks the centres of the boxes out of the plant's state, as a camera over the ward would.

    .. pydrake_system::

        name: ItemPositions
        input_ports:
        - state
        output_ports:
        - item_positions

    `state` is that of the whole plant; `item_positions` are x, y and z of each box in the world, metres, in the order
    of `items`.
    """

    def __init__(self, plant: MultibodyPlant, items: ItemBodies) -> None:
        """Looks at the boxes `items` of a finalized plant."""
        super().__init__()
        starts = [body.floating_positions_start() + _QUATERNION for body in items.bodies]
        self._indices = (np.array(starts, dtype=int).reshape(-1, 1) + np.arange(3)).ravel()
        self._state = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        self.DeclareVectorOutputPort(
            "item_positions",
            len(self._indices),
            self._calc_item_positions,
            prerequisites_of_calc={self._state.ticket()},
        )

    def _calc_item_positions(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._state.Eval(context)[self._indices])
