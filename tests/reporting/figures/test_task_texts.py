"""What is written into a task's graph."""

from __future__ import annotations

import pytest

from mala_drake.planning.task import PlanningTask
from mala_drake.reporting.figures.task_texts import TaskTexts

DOMAIN = """(define (domain d)
  (:requirements :strips :typing)
  (:types place - object shop depot - place)
  (:constants corner mall - shop cellar - depot)
  (:predicates (at ?p - place) (has ?r ?x) (clean ?r)))
"""
PROBLEM = "(define (problem p) (:domain d) (:objects r bread nuts) (:init (at mall)) (:goal (at mall)))"
BREAD, NUTS, CLEAN = ("has", "r", "bread"), ("has", "r", "nuts"), ("clean", "r")


@pytest.fixture
def texts():
    return TaskTexts(PlanningTask.parse(DOMAIN, PROBLEM).description, [BREAD, NUTS, CLEAN])


@pytest.mark.parametrize(
    ("gained", "states", "text"),
    [
        ([CLEAN], [{CLEAN}], "clean"),
        ([BREAD, NUTS], [{BREAD, NUTS}], "has bread and nuts"),
        ([BREAD, NUTS], [{BREAD}, {NUTS}], "has bread or nuts"),
        ([BREAD, CLEAN], [{BREAD, CLEAN}, {BREAD}], "has bread"),  # Clean it is in one of the states only.
        ([], [set()], ""),
    ],
)
def test_facts_are_told_without_what_they_agree_in(texts, gained, states, text):
    assert texts.facts(gained, [frozenset(state) for state in states]) == text


@pytest.mark.parametrize(
    ("actions", "places", "text"),
    [
        (("go_on",), (), "go on"),
        (("collect_a", "collect_b"), ("mall",), "collect a or b\nat mall"),
        (("put_down",), ("corner", "mall"), "put down\nat any shop"),
        (("put_down",), ("cellar",), "put down\nat cellar"),
        (("put_down",), ("cellar", "mall"), "put down\nat cellar or mall"),
        (("deliver_on_the_bedside_table",), (), "deliver on the\nbedside table"),
    ],
)
def test_actions_are_told_with_their_places(texts, actions, places, text):
    assert texts.action(actions, places) == text


def test_only_places_of_one_kind_have_a_kind(texts):
    assert texts.kind(("corner", "mall")) == "shop"
    assert texts.kind(("corner", "cellar")) is None
    assert texts.kind(()) is None
