"""Grounding keeps what can be reached, and no more, without enumerating what cannot."""

import itertools

import pytest

from mala_drake.planning import PlanningTask
from mala_drake.planning.limits import Budget, OutOfBudget


def actions_of(domain, problem):
    task = PlanningTask.parse(domain, problem)
    return [action.name for action in task.grounding(task.initial_state).ground_task.actions]


ROADS = """(define (domain d) (:types place truck)
  (:predicates (at ?t - truck ?p - place) (road ?a ?b - place) (closed ?p - place))
  (:functions (length ?a ?b - place))
  (:action drive :parameters (?t - truck ?a ?b - place)
    :precondition (and (at ?t ?a) CONDITION (not (closed ?b)) (not (= ?a ?b)))
    :effect (and (not (at ?t ?a)) (at ?t ?b))))"""


def roads_problem(count, *, facts):
    places = [f"p{index:02d}" for index in range(count)]
    links = " ".join(facts.format(a=a, b=b) for a, b in itertools.pairwise(places))
    return f"""(define (problem p) (:domain d) (:objects {" ".join(places)} - place t - truck)
      (:init (at t p00) (closed p05) {links}) (:goal (at t {places[-1]})))"""


@pytest.mark.parametrize(
    ("condition", "facts"), [("(road ?a ?b)", "(road {a} {b})"), ("(> (length ?a ?b) 0)", "(= (length {a} {b}) 3)")]
)
def test_static_facts_and_tables_of_numbers_prune(condition, facts):
    names = actions_of(ROADS.replace("CONDITION", condition), roads_problem(10, facts=facts))
    assert names == [f"(drive t p{index:02d} p{index + 1:02d})" for index in range(4)]


def test_many_parameters_do_not_explode():
    # Ten parameters over sixty objects: 60^10 bindings by enumeration, 51 along the chain.
    parameters = [f"?x{index}" for index in range(10)]
    chain = " ".join(f"(next {a} {b})" for a, b in itertools.pairwise(parameters))
    domain = f"""(define (domain d) (:predicates (next ?a ?b) (done ?a))
      (:action hop :parameters ({" ".join(parameters)}) :precondition (and {chain}) :effect (done ?x9)))"""
    objects = [f"o{index:02d}" for index in range(60)]
    facts = " ".join(f"(next {a} {b})" for a, b in itertools.pairwise(objects))
    problem = f"(define (problem p) (:domain d) (:objects {' '.join(objects)}) (:init {facts}) (:goal (done o59)))"
    assert len(actions_of(domain, problem)) == 51


def test_types_subtypes_and_either_restrict_parameters():
    domain = """(define (domain d) (:types car bus - vehicle vehicle stone) (:predicates (used ?x))
      (:action any :parameters (?x - vehicle) :effect (used ?x))
      (:action some :parameters (?x - (either bus stone)) :effect (used ?x)))"""
    problem = "(define (problem p) (:domain d) (:objects b - bus c - car s - stone v - vehicle) (:goal (used v)))"
    assert actions_of(domain, problem) == ["(any b)", "(any c)", "(any v)", "(some b)", "(some s)"]


def test_grounding_stops_when_the_time_is_up(load):
    task = load("logistics")
    fresh = PlanningTask(task.description)
    with pytest.raises(OutOfBudget):
        fresh.grounding(fresh.initial_state, Budget(timeout=0.0))


@pytest.mark.parametrize(
    ("precondition", "effect", "goal"),
    [
        ("(exists (?x ?y ?z) (and (p ?x) (p ?y) (p ?z)))", "(g)", "(g)"),
        ("()", "(forall (?x ?y ?z) (when (p ?x) (g)))", "(g)"),
        ("()", "(when (forall (?x ?y ?z) (p ?x)) (g))", "(g)"),
        ("()", "(g)", "(forall (?x ?y ?z) (or (g) (p ?x)))"),
    ],
)
def test_time_is_looked_at_for_everything_that_a_quantifier_ranges_over(precondition, effect, goal):
    class Counting(Budget):
        ticks = 0

        def tick(self):
            self.ticks += 1

    objects = " ".join(f"o{index}" for index in range(10))
    task = PlanningTask.parse(
        f"""(define (domain d) (:predicates (p ?x) (g))
          (:action a :precondition {precondition} :effect {effect}))""",
        f"(define (problem p) (:domain d) (:objects {objects}) (:init (p o1)) (:goal {goal}))",
    )
    budget = Counting()
    task.grounding(task.initial_state, budget)
    assert budget.ticks >= 10**3
