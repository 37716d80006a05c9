"""What is legal is read exactly, whatever `pddl` makes of it; what is not is refused in one line with its place."""

import sys
from fractions import Fraction

import pytest

import mala_drake.planning.reader as mut
from mala_drake.errors import BadInput
from mala_drake.planning import syntax

DOMAIN = """(define (domain d)
  (:requirements :adl :numeric-fluents)
  (:types truck - vehicle vehicle place)
  (:constants base - place)
  (:predicates (at ?v - vehicle ?p - place) (open))
  (:functions (fuel ?v - vehicle) (size))
  (:action go :parameters (?t - truck ?p - place)
    :precondition PRECONDITION
    :effect EFFECT))"""
PROBLEM = """(define (problem p) (:domain d)
  (:objects t - truck home - place)
  (:init (at t home) (= (fuel t) 1) INIT)
  (:goal GOAL)
  METRIC)"""


def read(precondition="()", effect="(open)", init="", goal="(open)", metric="", domain=DOMAIN, problem=PROBLEM):
    domain = domain.replace("PRECONDITION", precondition).replace("EFFECT", effect)
    problem = problem.replace("INIT", init).replace("GOAL", goal).replace("METRIC", metric)
    return mut.read_description(domain, problem, domain_name="d.pddl", problem_name="p.pddl")


def precondition_of(text):
    return read(precondition=text).actions[0].precondition


def effects_of(text):
    return read(effect=text).actions[0].effects


def increase(amount, fluent="size", terms=()):
    return syntax.SetFluent("increase", syntax.Fluent(fluent, terms), Fraction(amount))


def test_equal_effects_both_count():
    assert effects_of("(and (increase (size) 1) (increase (size) 1))") == (increase(1), increase(1))
    assert effects_of("(and (increase (size) 1) (increase (size) 1.0))") == (increase(1), increase(1))


def test_equal_effects_count_inside_when_and_forall():
    when = effects_of("(when (open) (and (increase (size) 1) (increase (size) 1)))")
    assert when == (syntax.When(syntax.Atom("open", ()), (increase(1), increase(1))),)
    (each,) = effects_of("(forall (?v - truck) (and (increase (size) 1) (increase (size) 1)))")
    assert each.effects == (increase(1), increase(1))


def test_empty_parentheses_are_true_as_a_condition_and_nothing_as_an_effect():
    assert precondition_of("()") == syntax.And(())
    assert effects_of("()") == ()
    assert read(goal="()").goal == syntax.And(())


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("-2", "-2"),
        ("+.5", "1/2"),
        ("1e-3", "1/1000"),
        ("2.", "2"),
        ("0.1", "1/10"),
        ("12345678901234567890.123456789", "12345678901234567890123456789/1000000000"),
    ],
)
def test_numbers_are_exact(written, value):
    assert read(init=f"(= (size) {written})").values["size",] == Fraction(value)
    assert effects_of(f"(increase (size) {written})") == (increase(Fraction(value)),)
    metric = read(init="(= (size) 1)", metric=f"(:metric minimize (* {written} (size)))").metric
    assert metric.expression.operands[0] == Fraction(value)


def test_case_does_not_matter():
    domain = DOMAIN.replace("PRECONDITION", "(open)").replace("EFFECT", "(not (open))")
    problem = PROBLEM.replace("INIT", "").replace("GOAL", "(open)").replace("METRIC", "")
    quiet = mut.read_description(domain, problem)
    assert mut.read_description(domain.upper(), problem.upper()) == quiet
    assert quiet.actions[0].precondition == syntax.Atom("open", ())


def test_unary_plus_and_bare_fluents():
    assert effects_of("(increase size (+ (* 2)))") == (increase(2),)


def test_sections_may_come_in_any_order_and_be_missing():
    domain = """(define (domain d) (:action a :effect (open)) (:predicates (open)) (:requirements :strips))"""
    problem = "(define (problem p) (:goal (open)) (:domain d))"
    description = mut.read_description(domain, problem)
    assert description.actions[0].precondition == syntax.And(())
    assert description.facts == frozenset()


def test_nested_when_and_forall_inside_when_are_unfolded():
    atom = syntax.Atom("open", ())
    (outer,) = effects_of("(when (open) (when (at ?t ?p) (and (not (open)))))")
    assert outer == syntax.When(syntax.And((atom, syntax.Atom("at", ("?t", "?p")))), (syntax.SetFact(atom, False),))
    (each,) = effects_of("(when (at ?t ?p) (forall (?p - place) (not (at ?t ?p))))")
    (when,) = each.effects
    inner = each.variables[0].name
    assert inner != "?p"
    assert when.condition == syntax.Atom("at", ("?t", "?p"))
    assert when.effects == (syntax.SetFact(syntax.Atom("at", ("?t", inner)), False),)


@pytest.mark.parametrize(
    "goal",
    [
        "(or (open) (at t home))",
        "(imply (open) (at t home))",
        "(forall (?p - place) (at t ?p))",
        "(exists (?p - place) (and (at t ?p) (not (= ?p base))))",
        "(and (>= (fuel t) 1) (not (open)))",
    ],
)
def test_goals_may_use_every_condition(goal):
    assert read(goal=goal).goal is not None


def test_untyped_names_before_typed_ones_and_either():
    domain = """(define (domain d) (:types a b c - object) (:predicates (p ?x ?y - (either a b)) (q ?z)))"""
    description = mut.read_description(domain, "(define (problem p) (:domain d) (:objects x - a y) (:goal (q y)))")
    assert description.predicates == {"p": (("a", "b"), ("a", "b")), "q": (("object",),)}
    assert description.objects == {"x": "a", "y": "object"}


def test_names_may_equal_keywords_of_pddl():
    domain = "(define (domain domain) (:predicates (define ?object) (number)) (:action problem :effect (number)))"
    problem = (
        "(define (problem problem) (:domain domain) (:objects minimize) (:init (define minimize)) (:goal (number)))"
    )
    assert mut.read_description(domain, problem).facts == {("define", "minimize")}


def test_total_cost_starts_at_zero_and_total_time_counts_steps():
    domain = "(define (domain d) (:predicates (open)) (:functions (total-cost)) (:action a :effect (open)))"
    problem = "(define (problem p) (:domain d) (:goal (open)) (:metric minimize (+ (total-cost) total-time)))"
    description = mut.read_description(domain, problem)
    assert description.values == {("total-cost",): 0, ("total-time",): 0}
    assert increase(1, "total-time") in description.actions[0].effects


def test_reading_leaves_tracebacks_alone_and_survives_a_mistake():
    before = getattr(sys, "tracebacklimit", None)
    with pytest.raises(BadInput):
        read(effect="(open")
    read()
    assert getattr(sys, "tracebacklimit", None) == before


@pytest.mark.parametrize(
    ("parts", "place", "words"),
    [
        ({"precondition": "(closed)"}, "d.pddl:8:20", "undeclared predicate 'closed'"),
        ({"precondition": "(at ?t)"}, "d.pddl:8:20", "'at' with 1 arguments; expected 2"),
        ({"precondition": "(at ?p ?p)"}, "d.pddl:8:23", "?p of type place"),
        ({"precondition": "(at ?x home)"}, "d.pddl:8:23", "undeclared variable ?x"),
        ({"precondition": "(at ?t home)"}, "d.pddl:8:26", "undeclared object 'home'"),
        ({"precondition": "(> (weight) 1)"}, "d.pddl:8:23", "undeclared function 'weight'"),
        ({"precondition": "(> (size) 1 2)"}, "d.pddl:8:19", "'>' with 3 arguments"),
        ({"precondition": "(> (size) 1.2.3)"}, "d.pddl:8:29", "'1.2.3' is not a number"),
        ({"precondition": "(not (open) (open))"}, "d.pddl:8:19", "'not' with 2 arguments"),
        ({"precondition": "open"}, "d.pddl:8:19", "'open' is not a condition"),
        ({"precondition": "(preference x (open))"}, "d.pddl:8:19", "preferences"),
        ({"precondition": "(at start (open))"}, "d.pddl:8:19", "timed"),
        ({"precondition": "(forall (?a - tree) (open))"}, "d.pddl:8:33", "unknown type 'tree'"),
        ({"precondition": "(forall ?a (open))"}, "d.pddl:8:27", "'?a' after 'forall'"),
        ({"effect": "(or (open) (open))"}, "d.pddl:9:13", "'or' out of place"),
        ({"effect": "(oneof (open) (open))"}, "d.pddl:9:13", "non-deterministic"),
        ({"effect": "(increase 3 1)"}, "d.pddl:9:23", "cannot increase '3'"),
        ({"effect": "(increase (size))"}, "d.pddl:9:13", "'increase' with 1 arguments"),
        ({"effect": "(increase (size) (+))"}, "d.pddl:9:30", "'+' with 0 operands"),
        ({"effect": "(not (not (open)))"}, "d.pddl:9:18", "'not' out of place"),
        (
            {"effect": "(forall (?v - (either truck place)) (at ?v ?p))"},
            "d.pddl:9:53",
            "?v of type place or truck in 'at'; expected type vehicle",
        ),
        ({"effect": "(forall (?v) (when (at ?v ?p) (not (at ?v ?p))))"}, "d.pddl:9:52", "?v of type object in 'at'"),
        ({"effect": "(forall (?v) (increase (fuel ?v) 1))"}, "d.pddl:9:42", "?v of type object in 'fuel'"),
        ({"init": "(at t)"}, "p.pddl:3:38", "'at' with 1 arguments"),
        ({"init": "(at home home)"}, "p.pddl:3:41", "home of type place in 'at'; expected type vehicle"),
        ({"init": "(at t moon)"}, "p.pddl:3:43", "undeclared object 'moon'"),
        ({"init": "(= (fuel t) 2)"}, "p.pddl:3:41", "two values for (fuel t)"),
        ({"init": "(= (size) lots)"}, "p.pddl:3:47", "not an initial value"),
        ({"init": "(not (at t home))"}, "p.pddl:3:", "both true and false"),
        ({"init": "(at 5 (open))"}, "p.pddl:3:37", "timed initial literals"),
        ({"goal": "(at t ?p)"}, "p.pddl:4:16", "undeclared variable ?p"),
        ({"goal": "(> (total-time) 3)"}, "p.pddl:4:14", "undeclared function 'total-time'"),
        ({"metric": "(:metric minimise (size))"}, "p.pddl:5:12", "not a metric"),
        ({"metric": "(:metric minimize (is-violated x))"}, "p.pddl:5:21", "preferences"),
        ({"metric": "(:metric minimize (width))"}, "p.pddl:5:22", "undeclared function 'width'"),
        ({"metric": "(:constraints (always (open)))"}, "p.pddl:5:3", "trajectory constraints"),
        ({"metric": "(:goal (open))"}, "p.pddl:5:3", "a second ':goal'"),
    ],
)
def test_mistakes_are_named_with_their_place(parts, place, words):
    with pytest.raises(BadInput) as caught:
        read(**parts)
    line = str(caught.value)
    assert line.startswith(place), line
    assert words in line
    assert "\n" not in line


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("(open))", "(open) (open))", "d.pddl:5:53", "'open' declared twice"),
        ("truck - vehicle", "truck - vehicle vehicle - truck", "d.pddl:3:27", "its own supertype"),
        ("vehicle place)", "vehicle place place)", "d.pddl:3:41", "declared twice"),
        ("base - place", "base base - place", "d.pddl:4:20", "object 'base' declared twice"),
        ("(fuel ?v - vehicle)", "(fuel ?v - vehicle) - truck", "d.pddl:6:37", "outside the supported fragment"),
        ("?t - truck ?p", "?t - truck ?t", "d.pddl:7:39", "variable ?t declared twice"),
        (":requirements :adl", ":requirements :magic", "d.pddl:2:18", "unknown requirement ':magic'"),
        ("(:action go", "(:durative-action go", "d.pddl:7:3", "durative actions"),
        ("(:action go", "(:derived (open) (and)) (:action go", "d.pddl:7:3", "derived predicates"),
        ("(:action go", "(:action go :effect (open)) (:action go", "d.pddl:7:40", "action 'go' defined twice"),
        (":precondition", ":duration", "d.pddl:8:5", "':duration' in an action"),
        ("(:types", "(:kinds", "d.pddl:3:3", "unknown section ':kinds'"),
        ("(domain d)", "(domain)", "d.pddl:1:9", "not a domain file"),
        ("EFFECT))", "EFFECT)", "d.pddl:1:1", "never closed"),
        ("EFFECT))", "EFFECT)))", "d.pddl:9:21", "without a matching"),
        ("EFFECT))", "EFFECT)) (more)", "d.pddl:9:22", "after the end"),
        ("?p - place)\n", "?p - )\n", "d.pddl:7:42", "'-' out of place"),
    ],
)
def test_mistakes_in_declarations_are_named_with_their_place(old, new, place, words):
    assert old in DOMAIN
    with pytest.raises(BadInput) as caught:
        read(domain=DOMAIN.replace(old, new))
    assert str(caught.value).startswith(place), str(caught.value)
    assert words in str(caught.value)


def test_a_problem_for_another_domain_is_refused():
    with pytest.raises(BadInput, match=r"p\.pddl:1:30: the problem is for domain 'other'; expected 'd'"):
        read(problem=PROBLEM.replace("(:domain d)", "(:domain other)"))


def test_a_problem_without_goal_is_refused():
    with pytest.raises(BadInput, match="no goal"):
        mut.read_description("(define (domain d))", "(define (problem p) (:domain d))")
