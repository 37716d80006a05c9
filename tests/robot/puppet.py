"""An ideal robot, for tests of what it does in place."""

from __future__ import annotations

from mala_drake.clock import TICK
from mala_drake.messages import Action, ActionKind, Outcome
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper
from mala_drake.robot.gripper_geometry import hanging_positions
from mala_drake.robot.in_place_execution import Execution, Senses, accept, advance
from mala_drake.robot.item_messages import HandedItem
from mala_drake.ward.items import all_items

MEDICINE, SUPPLEMENT = "pharmacy_north/med_antibiotic", "supply_A/supp_vitamin_d"


class Puppet:
    """An ideal robot: the arm is where it is told at the next tick, what the magnet wants hangs there at once."""

    def __init__(self, ward):
        self.ward = ward
        self.time = 0.0
        self.base = (0.0, 0.0, 0.0)
        self.joints = STOWED
        self.positions = {i.name: (i.shelf_pose.x, i.shelf_pose.y, i.shelf_pose.z) for i in all_items(ward)}
        self.charge = 0.8
        self.handed = HandedItem()
        self.slippery = set()  # Boxes that the magnet does not hold.
        self.execution = Execution()
        self.sequence = 0

    def stand_at(self, place):
        here = self.ward.place[place]
        self.base = (here.x, here.y, here.yaw)
        self.carry()

    def carry(self):
        for item, pad in self.execution.held:
            if item not in self.slippery:
                self.positions[item] = hanging_positions(self.base, self.joints)[pad]

    def senses(self):
        return Senses(self.time, self.base, self.joints, dict(self.positions), self.charge, self.handed)

    def begin(self, name, place, kind=ActionKind.IN_PLACE, arguments=()):
        self.sequence += 1
        action = Action(self.sequence, kind, name, ("robot1", *arguments), place, place)
        self.execution = accept(self.execution, action, self.senses(), self.ward)
        return self.execution

    def hand(self, item):
        self.handed = HandedItem(self.sequence, item)

    def tick(self):
        self.time += TICK
        self.charge += TICK * (self.execution.charging - self.execution.draw)
        self.execution = advance(self.execution, self.senses())
        p_BG = self.execution.arm.p_BG
        self.joints = STOWED if p_BG is None else joints_for_gripper(p_BG)
        self.carry()
        return self.execution

    def finish(self, limit=60.0):
        begun = self.time
        while self.execution.running and self.time - begun < limit:
            self.tick()
        return self.execution.outcome

    def do(self, name, place, item=None, arguments=()):
        self.begin(name, place, arguments=arguments)
        if item is not None:
            self.hand(item)
        return self.finish()

    def load(self):
        """Collects a medicine and a supplement."""
        self.stand_at("pharmacy_north")
        assert self.do("collect_med_antibiotic", "pharmacy_north", MEDICINE) is Outcome.SUCCESS
        self.stand_at("supply_A")
        assert self.do("collect_supp_vitamin_d", "supply_A", SUPPLEMENT) is Outcome.SUCCESS
