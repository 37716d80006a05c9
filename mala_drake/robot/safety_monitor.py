"""The safety monitor: how near the robot's body came to anything solid, and how often it touched."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from pydrake.common.value import Value
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from mala_drake.clock import PLANT_STEP
from mala_drake.messages import Shape
from mala_drake.robot.plant import CareRobot
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, X, Y
from mala_drake.robot.robot_parameters import NOMINAL
from mala_drake.ward.shapes import ShapeDistances

_NEAR = 0.03
"""Clearance below which contacts are looked at, m."""

_APART = 0.01
"""Clearance above which a contact is over, m: a robot that bounces or scrapes along has collided once."""

_MIN_CLEARANCE, _COLLISIONS, _IN_CONTACT, _ANCHOR_X, _ANCHOR_Y, _ANCHOR_CLEARANCE = range(6)
_START = (math.inf, 0.0, 0.0, 0.0, 0.0, -math.inf)


class SafetyMonitor(LeafSystem):
    """Watches the clearance and the collisions of the robot's body at every step of the plant.

    .. pydrake_system::

        name: SafetyMonitor
        input_ports:
        - plant_state
        - contact_results
        output_ports:
        - safety

    `plant_state` is the robot's own state port, `contact_results` the plant's. `safety` is [the smallest clearance so
    far, m, infinite when there is nothing solid; the number of collisions so far; 1 while in contact, else 0].

    The body is the hull alone, a disc seen from above: what arm, wheels and a carried item touch does not count.
    Clearance is exact at every step that could be a new minimum. A clearance changes no faster than the robot moves, so
    the steps in between need no distances: they only compare the way gone since the last evaluation.
    """

    def __init__(
        self,
        robot: CareRobot,
        footprints: Sequence[Shape],
        *,
        ignored: Iterable[BodyIndex] = (),
        body_radius: float = NOMINAL.body_radius,
    ) -> None:
        """Declares the monitor.

        Args:
            robot: whose hull is watched.
            footprints: of everything solid, mapped or not.
            ignored: bodies whose touch does not count, for example the items.
            body_radius: of the hull, m.
        """
        super().__init__()
        self._hull = robot.hull
        self._distances = ShapeDistances(footprints)
        self._count = len(footprints)
        self._ignored = {int(body) for body in ignored}
        self._body_radius = body_radius
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._contact_results = self.DeclareAbstractInputPort("contact_results", Value(ContactResults()))
        self._watch = self.DeclareDiscreteState(_START)
        self.DeclareVectorOutputPort(
            "safety", 3, self._calc_safety, prerequisites_of_calc={self.discrete_state_ticket(self._watch)}
        )
        self.DeclarePeriodicDiscreteUpdateEvent(PLANT_STEP, 0.0, self._update)

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        state = discrete_state.get_mutable_vector(self._watch)
        watch = state.value().tolist()
        plant_state = self._plant_state.Eval(context)
        x, y = plant_state.item(X), plant_state.item(Y)
        moved = math.hypot(x - watch[_ANCHOR_X], y - watch[_ANCHOR_Y])
        if watch[_ANCHOR_CLEARANCE] - moved >= max(watch[_MIN_CLEARANCE], _NEAR):
            return
        clearance = self._clearance(x, y)
        watch[_ANCHOR_X:] = x, y, clearance
        watch[_MIN_CLEARANCE] = min(watch[_MIN_CLEARANCE], clearance)
        if clearance < _NEAR and self._touches(context):
            watch[_COLLISIONS] += 1.0 - watch[_IN_CONTACT]
            watch[_IN_CONTACT] = 1.0
        elif clearance > _APART:
            watch[_IN_CONTACT] = 0.0
        state.SetFromVector(watch)

    def _clearance(self, x: float, y: float) -> float:
        if self._count == 0:
            return math.inf
        return float(self._distances((x, y)).min()) - self._body_radius

    def _touches(self, context: Context) -> bool:
        contacts = self._contact_results.Eval(context)
        for i in range(contacts.num_point_pair_contacts()):
            contact = contacts.point_pair_contact_info(i)
            pair = contact.point_pair()
            others = {int(contact.bodyA_index()), int(contact.bodyB_index())}
            if self._hull in (pair.id_A, pair.id_B) and not others & self._ignored:
                return True
        return False

    def _calc_safety(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state(self._watch).value()[:3])
