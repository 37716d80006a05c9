"""Classical planning: PDDL tasks to optimal plans, in process, exactly and the same every time."""

from mala_drake.planning.plan import Plan, plan_to_json
from mala_drake.planning.planner import Planner
from mala_drake.planning.state import SymbolicState
from mala_drake.planning.task import PlanningTask

__all__ = ["Plan", "Planner", "PlanningTask", "SymbolicState", "plan_to_json"]
