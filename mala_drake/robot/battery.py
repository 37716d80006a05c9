"""The battery: power in, state of charge out."""

from __future__ import annotations

import math

from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from mala_drake.clock import PLANT_STEP
from mala_drake.errors import BadInput
from mala_drake.robot.drive_law import DriveLaw
from mala_drake.ward.congestion import CRUISE_SPEED

CHARGE_PER_METRE = 0.01
"""Charge that driving one metre at cruise speed costs."""

CAPACITY = DriveLaw().cruise_power(CRUISE_SPEED) / CRUISE_SPEED / CHARGE_PER_METRE
"""Energy of the full battery, J.

At cruise the two wheels turn at 15 rad/s against 1.0 N m of rolling resistance each; with the drive's efficiency and
heat that is 36 W, and 24 J a metre, of which the full battery holds a hundred.
"""


class Battery(LeafSystem):
    """Integrates what is drawn from the battery and what is put into it.

    .. pydrake_system::

        name: Battery
        input_ports:
        - power
        - charge_rates
        output_ports:
        - charge

    `power` is the electrical power of the drive, W. `charge_rates` are what an in-place action takes and what a charger
    gives, both in charge per second. `charge` is the state of charge in [0, 1]; an empty battery stays
    empty until it is charged. A rate that is not finite counts as nothing: a broken reading must not fill a battery.
    """

    def __init__(self, *, initial_charge: float = 1.0, capacity: float = CAPACITY) -> None:
        """Declares the battery.

        Args:
            initial_charge: in [0, 1].
            capacity: energy of the full battery, J, positive.

        Raises:
            BadInput: either is out of its range.
        """
        super().__init__()
        if not 0.0 <= initial_charge <= 1.0:
            raise BadInput("battery initial_charge", repr(initial_charge), "a number in [0, 1]")
        if not (capacity > 0.0 and math.isfinite(capacity)):
            raise BadInput("battery capacity", repr(capacity), "a positive energy in J")
        self._capacity = capacity
        self._power = self.DeclareVectorInputPort("power", 1)
        self._charge_rates = self.DeclareVectorInputPort("charge_rates", 2)
        charge = self.DeclareDiscreteState([initial_charge])
        self.DeclareStateOutputPort("charge", charge)
        self.DeclarePeriodicDiscreteUpdateEvent(PLANT_STEP, 0.0, self._integrate)

    def _integrate(self, context: Context, discrete_state: DiscreteValues) -> None:
        draw, charging = self._charge_rates.Eval(context).tolist()
        rate = charging - draw - self._power.Eval(context).item() / self._capacity
        if math.isfinite(rate):
            state = discrete_state.get_mutable_vector()
            state.SetAtIndex(0, min(max(state.GetAtIndex(0) + PLANT_STEP * rate, 0.0), 1.0))
