from collections.abc import Callable
from pathlib import Path

import pytest

from mala_drake.planning import Planner, PlanningTask, limits
from mala_drake.planning.task_planner import TaskPlanner
from mala_drake.ward.ward_map import Ward

from .plan_steps import care_domain
from .planner_bench import PlannerBench

DATA = Path(__file__).parent.parent / "data" / "pddl"


@pytest.fixture(scope="session")
def load() -> Callable[[str], PlanningTask]:
    """Loads one of the small tasks by name, each once."""
    tasks: dict[str, PlanningTask] = {}

    def load_task(name: str) -> PlanningTask:
        if name not in tasks:
            tasks[name] = PlanningTask.load(DATA / f"{name}-domain.pddl", DATA / f"{name}-problem.pddl")
        return tasks[name]

    return load_task


@pytest.fixture(scope="module")
def task(request: pytest.FixtureRequest) -> PlanningTask:
    """The care domain that a module of tests is about, which it names in `DOMAIN`."""
    return care_domain(request.module.DOMAIN)


@pytest.fixture(scope="module")
def planner(task: PlanningTask) -> Planner:
    return Planner(task)


@pytest.fixture(scope="session")
def task_planner(ward: Ward) -> TaskPlanner:
    """One system for all tests: its contexts are independent of each other."""
    return TaskPlanner(ward)


@pytest.fixture
def bench(task_planner: TaskPlanner, ward: Ward) -> PlannerBench:
    """A bench of its own for each test."""
    return PlannerBench(task_planner, ward)


class Clock:
    """Stands for the module `time`; its seconds pass when a test says so."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The clock that budgets look at, for one test."""
    clock = Clock()
    monkeypatch.setattr(limits, "time", clock)
    return clock
