from collections.abc import Callable
from pathlib import Path

import pytest

from mala_drake.planning import PlanningTask

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
