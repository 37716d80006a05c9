"""Legs are read from actions with the domain's own effects."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mala_drake.planning.task import PlanningTask
from mala_drake.reporting import executed_legs as mut
from mala_drake.reporting.results import load_results
from mala_drake.ward.ward_map import LoadWard

DOMAIN = """(define (domain d)
  (:requirements :strips :typing)
  (:types place robot)
  (:constants kitchen - place)
  (:predicates (at ?r - robot ?p - place) (held))
  (:action go :parameters (?r - robot ?a ?b - place) :precondition (at ?r ?a) :effect (and (not (at ?r ?a)) (at ?r ?b)))
  (:action cook :parameters (?r - robot) :precondition (at ?r kitchen) :effect (held))
  (:action appear :parameters (?r - robot) :precondition (held) :effect (at ?r kitchen)))
"""
PROBLEM = "(define (problem p) (:domain d) (:objects r - robot hall - place) (:init (at r hall)) (:goal (held)))"


@pytest.mark.parametrize(
    ("action", "leg"),
    [
        ("(go r hall kitchen)", ("hall", "kitchen")),
        ("(cook r)", (None, None)),
        ("(appear r)", (None, "kitchen")),
        ("(fly r hall kitchen)", (None, None)),
        ("(go r hall)", (None, None)),
    ],
)
def test_a_movement_is_what_changes_where_the_robot_is(action, leg):
    description = PlanningTask.parse(DOMAIN, PROBLEM).description
    assert mut.movement({schema.name: schema for schema in description.actions}, action) == leg


def test_legs_are_counted_over_the_episodes_that_reached_their_goal(tmp_path, simulate_results):
    def change(record):
        if record.episode == 1:
            return replace(record, success=False, failure="blocked")
        return replace(record, actions=[*record.actions, "(approach_left_to_bed robot1 in_transit)"])

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=3, change=change)
    runs = load_results(tmp_path).runs
    found = mut.executed_legs(runs, "medication", LoadWard())
    assert (found.episodes, found.left_out) == (2, 2)
    assert sum(found.counts.values()) == 6
    starts = {start for start, _ in found.counts}
    assert "home" in starts
    assert {name for leg in found.counts for name in leg} <= set(LoadWard().place)


def test_a_task_that_nobody_knows_has_no_legs(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), tasks=("dancing",))
    assert not mut.executed_legs(load_results(tmp_path).runs, "dancing", LoadWard()).counts
