"""The benchmarks by name: each exists, and gives rows that fit one table."""

from __future__ import annotations

import inspect
import itertools

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import bench as mut
from mala_drake.experiments import bench_plan

# A street of places in both directions: blind search goes down the wrong one too.
PLACES = [f"p{i}" for i in range(9)]
DOMAIN = """(define (domain street)
  (:requirements :strips :numeric-fluents)
  (:predicates (at ?p) (joined ?p ?q))
  (:functions (cost) (w0) (w1) (w2) (w3) (w4))
  (:action go :parameters (?p ?q) :precondition (and (at ?p) (joined ?p ?q))
    :effect (and (not (at ?p)) (at ?q) (increase (cost) (+ (w0) (+ (w1) (+ (w2) (+ (w3) (w4)))))))))
"""
PROBLEM = f"""(define (problem home) (:domain street) (:objects {" ".join(PLACES)})
  (:init (at p4) (= (cost) 0) {" ".join(f"(= (w{i}) 0.2)" for i in range(5))}
    {" ".join(f"(joined {p} {q}) (joined {q} {p})" for p, q in itertools.pairwise(PLACES))})
  (:goal (at p8)) (:metric minimize (cost)))
"""


@pytest.mark.parametrize("name", mut.BENCHMARKS)
def test_each_benchmark_can_be_run_without_arguments(name):
    function = mut._benchmark(name)
    assert function.__name__ == f"bench_{name}"
    inspect.signature(function).bind()


def test_an_unknown_benchmark_is_refused():
    with pytest.raises(
        BadInput, match=r"bench: 'patience'; expected one of plant, mpc, agreement, plan, episode, sensitivities"
    ):
        mut.run_benchmarks("patience")


def test_one_is_run_by_name_and_all_of_them_without(monkeypatch):
    monkeypatch.setattr(mut, "_benchmark", lambda name: lambda: [{"benchmark": name}])
    assert mut.run_benchmarks("mpc") == {"mpc": [{"benchmark": "mpc"}]}
    assert mut.run_benchmarks(None) == {name: [{"benchmark": name}] for name in mut.BENCHMARKS}


def check_planning_rows(rows):
    assert [row["task"] for row in rows] == ["medication"] * 2 + ["meal"] * 2
    assert [row["search"] for row in rows] == ["astar", "ucs"] * 2
    assert [row["replans"] for row in rows] == [3, 1] * 2
    for row in rows:
        assert list(row) == list(rows[0])
        assert 0.0 < row["median_ms"] <= row["p95_ms"] <= row["max_ms"]
    # The heuristic is what makes it fast: expansions do not depend on the machine.
    for guided, blind in (rows[:2], rows[2:]):
        assert guided["mean_expansions"] < blind["mean_expansions"]


def test_planning_is_measured_by_both_searches(monkeypatch, tmp_path):
    for stem in ("med", "meal"):
        (tmp_path / f"domain_{stem}.pddl").write_text(DOMAIN)
        (tmp_path / f"problem_{stem}.pddl").write_text(PROBLEM)
    monkeypatch.setattr(bench_plan, "_REPLANS", 3)
    monkeypatch.setattr(bench_plan, "domains_folder", lambda: tmp_path)
    check_planning_rows(bench_plan.bench_plan())


@pytest.mark.slow
def test_planning_both_tasks_is_measured_by_both_searches(monkeypatch):
    monkeypatch.setattr(bench_plan, "_REPLANS", 3)
    check_planning_rows(bench_plan.bench_plan())
