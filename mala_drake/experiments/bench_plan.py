"""Benchmark of the planner: reading, grounding, and replanning both tasks with new weights."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from mala_drake.planning import Planner, PlanningTask
from mala_drake.randomness import keyed_generator
from mala_drake.resources import domains_folder

_REPLANS = 200


def bench_plan() -> list[dict[str, Any]]:
    """A row a task for A* and one for blind search: medians and percentiles in milliseconds, and mean expansions."""
    return [row for name, stem in (("medication", "med"), ("meal", "meal")) for row in _rows(name, stem)]


def _rows(name: str, stem: str) -> list[dict[str, Any]]:
    folder = domains_folder()
    started = time.perf_counter()
    task = PlanningTask.load(folder / f"domain_{stem}.pddl", folder / f"problem_{stem}.pddl")
    load_ms = 1e3 * (time.perf_counter() - started)
    return [
        {"task": name} | _replan(task, search, count, load_ms) for search, count in (("astar", _REPLANS), ("ucs", 1))
    ]


def _replan(task: PlanningTask, search: Any, count: int, load_ms: float) -> dict[str, Any]:
    planner = Planner(task, search=search)
    planner.solve()  # Grounds, once and for all.
    generator = keyed_generator(0, 0, "bench_plan")
    times, expanded = [], []
    for _ in range(count):
        weights = [round(float(weight), 6) for weight in generator.dirichlet(np.ones(5))]
        started = time.perf_counter()
        plan = planner.solve(weights=weights)
        times.append(1e3 * (time.perf_counter() - started))
        expanded.append(plan.expanded)
    return {
        "search": search,
        "load_ms": load_ms,
        "replans": count,
        "median_ms": float(np.median(times)),
        "p95_ms": float(np.percentile(times, 95)),
        "max_ms": max(times),
        "mean_expansions": float(np.mean(expanded)),
    }
