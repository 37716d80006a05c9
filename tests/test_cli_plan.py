"""`mala-drake plan`: its JSON, its exit status, and what is wrong with PDDL in one line."""

from __future__ import annotations

import json

import pytest

from mala_drake.resources import domains_folder

from .command_line import call, mistake

MEDICATION = [str(domains_folder() / "domain_med.pddl"), str(domains_folder() / "problem_med.pddl")]

DOMAIN = """(define (domain lamp)
  (:requirements :strips)
  (:predicates (on) (broken))
  (:action switch :parameters () :precondition (not (broken)) :effect (on)))
"""
PROBLEM = "(define (problem light) (:domain lamp) (:init {init}) (:goal (on)))\n"
PLAN_KEYS = ["status", "cost", "actions", "expanded", "search_ms", "parse_ms", "ground_ms"]


@pytest.fixture
def lamp(tmp_path):
    def write(init="", domain=DOMAIN):
        (tmp_path / "domain.pddl").write_text(domain)
        (tmp_path / "problem.pddl").write_text(PROBLEM.format(init=init))
        return tmp_path / "domain.pddl", tmp_path / "problem.pddl"

    return write


def test_a_plan_as_json_has_the_agreed_keys(capfd):
    status, output, errors = call(capfd, "plan", *MEDICATION, "--json")
    plan = json.loads(output)
    assert (status, errors) == (0, "")
    assert list(plan) == PLAN_KEYS
    assert plan["status"] == "optimal"
    assert plan["actions"][-1].startswith("(deliver_on_bedside_table_")


def test_a_plan_for_people_ends_with_its_cost(capfd, lamp):
    status, output, _ = call(capfd, "plan", *lamp())
    assert status == 0
    assert "(switch)" in output.splitlines()[0]
    assert output.splitlines()[-1].startswith("optimal, cost 1; ")


def test_weights_change_what_a_plan_costs(capfd):
    costs = {}
    for weights in ("1,0,0,0,0", "0,1,0,0,0"):
        costs[weights] = json.loads(call(capfd, "plan", *MEDICATION, "--weights", weights, "--json")[1])["cost"]
    assert len(set(costs.values())) == 2


def test_weights_for_a_domain_without_them_are_a_mistake(capfd, lamp):
    line = mistake(capfd, "plan", *lamp(), "--weights", "0.2,0.2,0.2,0.2,0.2")
    for word in ("--weights", "domain.pddl", "(w0)"):
        assert word in line


def test_no_plan_is_status_one_and_still_json(capfd, lamp):
    status, output, errors = call(capfd, "plan", *lamp(init="(broken)"), "--json")
    plan = json.loads(output)
    assert (status, errors) == (1, "")
    assert (plan["status"], plan["cost"], plan["actions"]) == ("unsolvable", None, [])


def test_no_time_is_status_one_and_still_json(capfd):
    status, output, errors = call(capfd, "plan", *MEDICATION, "--timeout", "1e-6", "--json")
    assert (status, errors) == (1, "")
    assert json.loads(output)["status"] == "timeout"


@pytest.mark.parametrize("search", ["astar", "ucs"])
def test_both_searches_find_the_same_cost(capfd, lamp, search):
    assert json.loads(call(capfd, "plan", *lamp(), "--search", search, "--json")[1])["cost"] == 1


@pytest.mark.parametrize(
    ("domain", "words"),
    [
        ("", ["domain.pddl", "empty"]),
        ("(define (domain lamp", ["domain.pddl:1", "never closed"]),
        (DOMAIN.replace("(broken))\n", ")\n"), ["domain.pddl:4", "broken"]),
        (DOMAIN.replace("(:action", "(:durative-action"), ["domain.pddl:4", "durative"]),
        (DOMAIN.replace("(not (broken))", "(not (broken ?x))"), ["domain.pddl:4"]),
        (DOMAIN.replace("(domain lamp)", "(domain torch)"), ["torch", "lamp"]),
    ],
)
def test_a_mistake_in_pddl_names_file_and_line(capfd, lamp, domain, words):
    line = mistake(capfd, "plan", *lamp(domain=domain))
    for word in words:
        assert word in line


def dear_lamp(lamp, factors):
    """A lamp whose switching costs a power of 1e999."""
    price = f"(* {' '.join(['1e999'] * factors)})"
    domain = DOMAIN.replace("(:action", "(:functions (c)) (:action")
    domain = domain.replace(":effect (on)", f":effect (and (on) (increase (c) {price}))")
    return lamp(init="(= (c) 0)) (:metric minimize (c)", domain=domain)


def test_costs_that_no_float_can_hold_are_told(capfd, lamp):
    status, output, errors = call(capfd, "plan", *dear_lamp(lamp, 2))
    assert (status, errors) == (0, "")
    assert "cost 1.00000e+1998;" in output
    assert json.loads(call(capfd, "plan", *dear_lamp(lamp, 2), "--json")[1])["cost"] == 10**1998


def test_costs_with_too_many_digits_for_json_are_a_mistake(capfd, lamp):
    assert "problem.pddl: :metric: a cost with more than" in mistake(capfd, "plan", *dear_lamp(lamp, 5), "--json")
