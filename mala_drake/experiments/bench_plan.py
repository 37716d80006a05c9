"""Benchmark of the planner: reading, grounding, and replanning both tasks with new weights, beside value iteration."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.cost_to_go import value_iteration
from mala_drake.planning.state import Amount, Name
from mala_drake.planning.state_graph import explore
from mala_drake.randomness import keyed_generator
from mala_drake.resources import domains_folder

_REPLANS = 200
_TABLES = 3  # Replans by value iteration.
_CHARGE_STEPS = 50  # Of a full battery, in what value iteration solves: exact charges make a million states.

_Solve = Callable[[Sequence[float]], tuple[Fraction | None, int]]
"""From weights to the cost of an optimal plan, and how many states it took."""


def bench_plan() -> list[dict[str, Any]]:
    """Rows a task for A*, blind search and value iteration: medians and percentiles in milliseconds, mean expansions.

    Value iteration is of the task with charges rounded up to steps of 2 % of the battery, on a table of all states that
    can be reached, which is made anew for each replan. `agreeing` counts the replans that cost exactly what A* says of
    the same task and weights.
    """
    return [row for name, stem in (("medication", "med"), ("meal", "meal")) for row in _rows(name, stem)]


def _rows(name: str, stem: str) -> list[dict[str, Any]]:
    folder = domains_folder()
    started = time.perf_counter()
    task = PlanningTask.load(folder / f"domain_{stem}.pddl", folder / f"problem_{stem}.pddl")
    load_ms = 1e3 * (time.perf_counter() - started)
    planner, charges = Planner(task), _coarse_charges(task)
    planner.solve()  # Grounds, once and for all.
    astar = _by_search(planner)
    return [
        {"task": name, "search": search, "load_ms": load_ms} | _replan(solve, truth, count)
        for search, solve, truth, count in (
            ("astar", astar, astar, _REPLANS),
            ("ucs", _by_search(Planner(task, search="ucs")), astar, 1),
            ("value iteration", _by_table(task, charges), _by_search(planner, charges), _TABLES),
        )
    ]


def _by_search(planner: Planner, fluents: Mapping[Name, Amount] | None = None) -> _Solve:
    def solve(weights: Sequence[float]) -> tuple[Fraction | None, int]:
        plan = planner.solve(weights=weights, fluents=fluents)
        return plan.cost, plan.expanded

    return solve


def _by_table(task: PlanningTask, fluents: Mapping[Name, Amount]) -> _Solve:
    def solve(weights: Sequence[float]) -> tuple[Fraction | None, int]:
        graph = explore(task, weights=weights, fluents=fluents)
        return value_iteration(graph).cost(), graph.size

    return solve


def _coarse_charges(task: PlanningTask) -> dict[Name, Amount]:
    charges = {name: value for name, value in task.initial_state.values.items() if name[0].endswith("-battery")}
    return {name: Fraction(math.ceil(value * _CHARGE_STEPS), _CHARGE_STEPS) for name, value in charges.items()}


def _replan(solve: _Solve, truth: _Solve, count: int) -> dict[str, Any]:
    generator = keyed_generator(0, 0, "bench_plan")
    times, expanded, agreeing = [], [], 0
    for _ in range(count):
        weights = [round(float(weight), 6) for weight in generator.dirichlet(np.ones(5))]
        started = time.perf_counter()
        cost, states = solve(weights)
        times.append(1e3 * (time.perf_counter() - started))
        expanded.append(states)
        agreeing += cost == truth(weights)[0]
    return {
        "replans": count,
        "agreeing": agreeing,
        "median_ms": float(np.median(times)),
        "p95_ms": float(np.percentile(times, 95)),
        "max_ms": max(times),
        "mean_expansions": float(np.mean(expanded)),
    }
