"""A task as a graph: it is what the PDDL says, and states are merged exactly when they have the same future."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.planner import Planner
from mala_drake.planning.task import PlanningTask
from mala_drake.reporting import task_graph as mut
from mala_drake.ward.ward_map import LoadWard

DOMAIN = """(define (domain errands)
  (:requirements :strips :typing :negative-preconditions :numeric-fluents)
  (:types place thing robot)
  (:predicates (at ?r - robot ?p - place) (held ?t - thing) (letter-posted) (shop ?p - place) (home ?p - place) (done))
  (:functions (charge))
  (:action go :parameters (?r - robot ?a ?b - place)
    :precondition (and (at ?r ?a) (>= (charge) 1)) :effect (and (not (at ?r ?a)) (at ?r ?b) (decrease (charge) 1)))
  (:action take :parameters (?r - robot ?p - place ?t - thing)
    :precondition (and (at ?r ?p) (shop ?p) (not (held ?t))) :effect (held ?t))
  (:action post :parameters (?r - robot) :precondition (not (letter-posted)) :effect (letter-posted))
  (:action finish :parameters (?r - robot ?p - place ?t - thing)
    :precondition (and (at ?r ?p) (home ?p) (held ?t) (letter-posted)) :effect (done)))
"""
PROBLEM = """(define (problem p) (:domain errands)
  (:objects r - robot market den - place apple pear - thing)
  (:init (at r den) (shop market) (home den) (= (charge) 0))
  (:goal (done)))
"""


@pytest.fixture
def errands():
    return mut.task_graph(PlanningTask.parse(DOMAIN, PROBLEM))


def test_numbers_and_movements_are_left_out_and_places_are_kept(errands):
    """Nothing can be driven with an empty battery, yet the graph shows what the facts allow."""
    (taking,) = [part for part in errands.parts if len(part.nodes) > 2]
    assert {edge.actions for edge in taking.edges} == {("take",)}
    assert {edge.places for edge in taking.edges} == {("market",)}
    assert (errands.goal_actions, errands.goal_places) == (("finish",), ("den",))


def test_what_can_be_done_in_any_order_is_in_different_parts(errands):
    posting = [part for part in errands.parts if any(edge.actions == ("post",) for edge in part.edges)]
    assert len(errands.parts) == 2
    assert [len(part.nodes) for part in posting] == [2]
    assert posting[0].ready == (1,)
    assert posting[0].edges[0].places == ()  # It can be done anywhere.


def test_states_with_the_same_future_are_one_node(errands):
    """With an apple or with a pear one can finish as well; with both nothing more can be taken."""
    (taking,) = [part for part in errands.parts if len(part.nodes) > 2]
    held = [{frozenset(fact[1] for fact in state) for state in states} for states in taking.nodes]
    assert held == [{frozenset()}, {frozenset({"apple"}), frozenset({"pear"})}, {frozenset({"apple", "pear"})}]
    assert taking.ready == (1, 2)
    assert taking.edges[0].gained == {("held", "apple"), ("held", "pear")}


def test_all_states_are_counted_up_to_the_goal(errands):
    """Two places, two things and a letter make 16 states, and the goal can be reached from the 3 that are ready."""
    assert errands.states == 16 + 3


def test_objects_are_named_where_an_action_leads_to_several_nodes():
    """There is room for one thing only, and only the pear is ripe."""
    domain = DOMAIN.replace("(done))\n", "(done) (full) (ripe ?t - thing))\n", 1)
    domain = domain.replace("(held ?t) (letter", "(held ?t) (ripe ?t) (letter")
    domain = domain.replace("(not (held ?t))) :effect (held ?t)", "(not (full))) :effect (and (full) (held ?t))")
    graph = mut.task_graph(PlanningTask.parse(domain, PROBLEM.replace("(= (charge) 0)", "(= (charge) 0) (ripe pear)")))
    (taking,) = [part for part in graph.parts if len(part.nodes) > 2]
    assert {edge.actions for edge in taking.edges} == {("take apple",), ("take pear",)}
    (right,) = [edge for edge in taking.edges if edge.actions == ("take pear",)]
    assert taking.ready == (right.target,)


def test_what_cannot_be_done_in_any_order_is_one_part():
    """One cannot come back from the market, so nothing can be posted at home after shopping."""
    one_way = (
        DOMAIN.replace("(>= (charge) 1)", "(home ?a)")
        .replace("(not (letter-posted)) :effect", "(and (at ?r den) (not (letter-posted))) :effect")
        .replace("(home ?p) (held ?t)", "(held ?t)")
        .replace("(:predicates", "(:constants den - place)\n  (:predicates")
    )
    graph = mut.task_graph(PlanningTask.parse(one_way, PROBLEM.replace("market den", "market")))
    assert len(graph.parts) == 1


def test_a_goal_that_cannot_be_reached_has_no_graph():
    with pytest.raises(ValueError, match="no goal"):
        mut.task_graph(PlanningTask.parse(DOMAIN, PROBLEM.replace("(home den)", "")))


states = st.lists(
    st.tuples(st.integers(0, 6), st.sampled_from("ab"), st.integers(0, 6)), min_size=1, max_size=14, unique=True
)


@given(edges=states, ready=st.sets(st.integers(0, 6)))
def test_merging_is_the_coarsest_bisimulation(edges, ready):
    """Against the textbook's greatest fixed point on pairs of states."""
    names = [frozenset({("fact", str(i))}) for i in range(7)]
    merged = mut.bisimulation(names, [(names[a], name, names[b]) for a, name, b in edges], {names[i] for i in ready})
    following = {i: {(name, b) for a, name, b in edges if a == i} for i in range(7)}
    alike = {(i, j) for i, j in product(range(7), repeat=2) if (i in ready) == (j in ready)}

    def matched(i, j):
        return all(any(n == m and (x, y) in alike for m, y in following[j]) for n, x in following[i])

    while True:
        kept = {(i, j) for i, j in alike if matched(i, j) and matched(j, i)}
        if kept == alike:
            break
        alike = kept
    assert {(i, j) for i, j in product(range(7), repeat=2) if merged[names[i]] == merged[names[j]]} == alike
    assert sorted(set(merged.values())) == list(range(len(set(merged.values()))))


WEIGHTS = ((0.2,) * 5, (1.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.6, 0.0, 0.0, 0.4), (0.0, 0.0, 0.0, 1.0, 0.0))


@pytest.fixture(scope="module", params=TASK_NAMES)
def care_task(request):
    task = CareTask(request.param, LoadWard()).planning_task
    return task, mut.task_graph(task)


@pytest.mark.parametrize("weights", WEIGHTS)
def test_every_optimal_plan_is_a_path_through_the_graph(care_task, weights):
    task, graph = care_task
    at = [0] * len(graph.parts)
    for text in Planner(task).solve(weights=weights).actions:
        name = text.strip("()").split()[0]
        for number, part in enumerate(graph.parts):
            found = [
                edge.target
                for edge in part.edges
                if edge.source == at[number] and any(action.split()[0] == name for action in edge.actions)
            ]
            named = [
                edge.target
                for edge in part.edges
                if edge.source == at[number]
                and any(
                    action.split() == [name, *(o for o in text.strip("()").split() if o in action.split()[1:])]
                    for action in edge.actions
                )
            ]
            if found:
                (at[number],) = named
    assert all(node in part.ready for node, part in zip(at, graph.parts, strict=True))


def test_the_graph_is_small_enough_to_be_read(care_task):
    _, graph = care_task
    assert sum(len(part.nodes) for part in graph.parts) <= 30 < graph.states


def test_a_wrong_medicine_can_only_be_checked_and_put_down():
    """The correction branch of the paper: collect the wrong one, find out, put it down, begin again."""
    graph = mut.task_graph(CareTask("medication", LoadWard()).planning_task)
    (part,) = [each for each in graph.parts if any("put_down_medicine" in edge.actions for edge in each.edges)]
    edges = {edge.actions: (edge.source, edge.target) for edge in part.edges}
    start, wrong = edges["collect_med_analgesic", "collect_med_insulin"]
    assert [edge.actions for edge in part.edges if edge.source == wrong] == [("check_medication_wrong",)]
    found = edges["check_medication_wrong",][1]
    assert edges["put_down_medicine",] == (found, start)
    assert start == 0
