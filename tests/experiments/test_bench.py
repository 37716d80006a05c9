"""The benchmarks by name: each exists, and gives rows that fit one table."""

from __future__ import annotations

import inspect
import itertools
from fractions import Fraction

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
    assert [row["task"] for row in rows] == ["medication"] * 3 + ["meal"] * 3
    assert [row["search"] for row in rows] == ["astar", "ucs", "value iteration"] * 2
    assert [row["replans"] for row in rows] == [3, 1, 2] * 2
    for row in rows:
        assert list(row) == list(rows[0])
        assert row["agreeing"] == row["replans"]
        assert 0.0 < row["median_ms"] <= row["p95_ms"] <= row["max_ms"]
    # The heuristic is what makes it fast: expansions do not depend on the machine.
    for guided, blind, _ in (rows[:3], rows[3:]):
        assert guided["mean_expansions"] < blind["mean_expansions"]


@pytest.fixture
def few_replans(monkeypatch):
    monkeypatch.setattr(bench_plan, "_REPLANS", 3)
    monkeypatch.setattr(bench_plan, "_TABLES", 2)


@pytest.fixture
def street(monkeypatch, tmp_path, few_replans):
    for stem in ("med", "meal"):
        (tmp_path / f"domain_{stem}.pddl").write_text(DOMAIN)
        (tmp_path / f"problem_{stem}.pddl").write_text(PROBLEM)
    monkeypatch.setattr(bench_plan, "domains_folder", lambda: tmp_path)


def test_planning_is_measured_by_both_searches_and_by_value_iteration(street):
    rows = bench_plan.bench_plan()
    check_planning_rows(rows)
    assert [row["mean_expansions"] for row in rows if row["search"] == "value iteration"] == [len(PLACES)] * 2


def test_costs_that_are_not_those_of_the_planner_do_not_agree(street, monkeypatch):
    monkeypatch.setattr(bench_plan, "_by_table", lambda *_: lambda _: (Fraction(7), 9))
    assert [row["agreeing"] for row in bench_plan.bench_plan()] == [3, 1, 0] * 2


@pytest.mark.slow
def test_planning_both_tasks_is_measured_by_both_searches_and_by_value_iteration(few_replans):
    check_planning_rows(bench_plan.bench_plan())
