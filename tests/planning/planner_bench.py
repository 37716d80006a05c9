"""A task planner alone, with everything around it played by the test."""

from __future__ import annotations

from typing import Any

from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

from mala_drake import clock
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    Atom,
    Outcome,
    PlanMessage,
    Preferences,
    SymbolicState,
    Task,
    TaskReport,
)
from mala_drake.patient.profiles import PROFILES
from mala_drake.planning.task_planner import TaskPlanner
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import Ward

HAVE = (("has-medication",), ("medication-is", "med_antibiotic"))
"""What the robot knows of a medicine that it has not checked."""


class PlannerBench:
    """The planner alone, with everything around it played by the test."""

    def __init__(self, planner: TaskPlanner, ward: Ward) -> None:
        self.ward = ward
        self.simulator = Simulator(planner)
        self.context = self.simulator.get_mutable_context()
        self.planner = planner
        self._fixed = {
            name: planner.GetInputPort(name).FixValue(self.context, Value(value))
            for name, value in (
                ("task", Task()),
                ("symbolic_state", SymbolicState()),
                ("leg_report", ActionReport()),
                ("in_place_report", ActionReport()),
                ("preferences", Preferences(planning=PROFILES["speed_oriented"])),
            )
        }
        self.see("home")

    def give(self, name: str, value: Any) -> None:
        self._fixed[name].GetMutableData().set_value(value)

    def see(
        self,
        place: str,
        *own: tuple[str, ...],
        charge: float = 1.0,
        pose: tuple[float, float, float] | None = None,
        without: tuple[Atom, ...] = (),
    ) -> None:
        """Full shelves but for `without`; the robot at a place, or in transit at a pose, with some atoms of its own."""
        atoms: list[Atom] = [("available", item.kind, item.place) for item in all_items(self.ward)]
        atoms = [atom for atom in atoms if atom not in without]
        atoms += [(name, "robot1", *rest) for name, *rest in own]
        atoms += [("at", "robot1", place)] if place else []
        self.give("symbolic_state", SymbolicState(tuple(sorted(atoms)), place, charge))
        if pose is None:
            there = self.ward.place[place]
            pose = (there.x, there.y, there.yaw)
        self.planner.GetInputPort("robot_state").FixValue(self.context, [*pose, 0.0, 0.0, 0.0])

    def tick(self, count: int = 1) -> None:
        """Past the planner's moment in the next ticks."""
        for _ in range(count):
            self.simulator.AdvanceTo(self.context.get_time() + clock.TICK)

    def start(self, *, sequence: int = 1, name: str = "medication") -> Action:
        self.give("task", Task(sequence, name, sequence - 1))
        self.tick()
        return self.action

    def report(self, outcome: Outcome = Outcome.SUCCESS, *, detail: str = "") -> Action:
        """The current action has ended; its kind's executor says so."""
        port = "leg_report" if self.action.kind is ActionKind.MOVE else "in_place_report"
        self.give(port, ActionReport(self.action.sequence, outcome, detail=detail))
        self.tick()
        return self.action

    @property
    def action(self) -> Action:
        action: Action = self.planner.GetOutputPort("action").Eval(self.context)
        return action

    @property
    def plan(self) -> PlanMessage:
        plan: PlanMessage = self.planner.GetOutputPort("plan").Eval(self.context)
        return plan

    @property
    def task_report(self) -> TaskReport:
        report: TaskReport = self.planner.GetOutputPort("task_report").Eval(self.context)
        return report

    def start_at_the_pharmacy(self) -> None:
        """The robot stands at the northern pharmacy and is about to collect."""
        self.start()
        self.see("pharmacy_north", charge=0.8)
        self.report()
        assert self.action.name == "collect_med_antibiotic"
