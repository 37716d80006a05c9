"""Classical planning: PDDL tasks to optimal plans, in process, exactly and the same every time."""

from mala_drake.planning.cost_to_go import CostToGo, value_iteration
from mala_drake.planning.from_files import solve_files
from mala_drake.planning.plan import Plan, plan_to_json
from mala_drake.planning.planner import Planner
from mala_drake.planning.q_learning import QLearning
from mala_drake.planning.state import SymbolicState
from mala_drake.planning.state_graph import StateGraph, explore
from mala_drake.planning.task import PlanningTask
from mala_drake.planning.validation import Verdict, validate_plan

__all__ = [
    "CostToGo",
    "Plan",
    "Planner",
    "PlanningTask",
    "QLearning",
    "StateGraph",
    "SymbolicState",
    "Verdict",
    "explore",
    "plan_to_json",
    "solve_files",
    "validate_plan",
    "value_iteration",
]
