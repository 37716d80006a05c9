"""Actions do what the PDDL says: conditions look at the state before, deletions come first, numbers are exact."""

from fractions import Fraction

import pytest

from mala_drake.planning import Planner, PlanningTask


def task_with(effect, precondition="()", init="(p) (= (x) 3) (= (y) 2)"):
    domain = f"""(define (domain d) (:predicates (p) (q)) (:functions (x) (y) (z))
      (:action a :precondition {precondition} :effect {effect}))"""
    return PlanningTask.parse(domain, f"(define (problem p) (:domain d) (:init {init}) (:goal (q)))")


def after(effect, **options):
    task = task_with(effect, **options)
    return task.apply(task.initial_state, "(a)")


def test_additions_win_over_deletions():
    assert after("(and (not (p)) (p))").holds("(p)")
    assert after("(and (p) (not (p)))").holds("(p)")


def test_conditional_effects_look_at_the_state_before():
    state = after("(and (not (p)) (when (p) (q)) (assign (x) (y)) (assign (y) (x)))")
    assert state.holds("(q)")
    assert (state.value("x"), state.value("y")) == (2, 3)


def test_equal_increases_add_up():
    assert after("(and (increase (x) 0.1) (increase (x) 0.1) (decrease (x) 0.05))").value("x") == Fraction(63, 20)


def test_scaling_is_exact_and_commutes():
    assert after("(and (scale-up (x) 5) (scale-down (x) 7))").value("x") == Fraction(15, 7)


@pytest.mark.parametrize(
    "effect",
    [
        "(and (assign (x) 1) (assign (x) 2))",
        "(and (assign (x) 1) (increase (x) 2))",
        "(and (scale-up (x) 1) (increase (x) 2))",
        "(increase (z) 1)",
        "(assign (x) (z))",
        "(assign (x) (/ 1 (- (x) 3)))",
        "(scale-down (x) 0)",
        "(when (p) (increase (z) 1))",
    ],
)
def test_conflicting_and_undefined_effects_make_the_action_inapplicable(effect):
    task = task_with(f"(and (q) {effect})")
    with pytest.raises(ValueError, match="undefined"):
        task.apply(task.initial_state, "(a)")
    assert task.applicable(task.initial_state) == ()
    assert Planner(task).solve().status == "unsolvable"


def test_equal_assignments_do_not_conflict():
    assert after("(and (assign (z) 2) (assign (z) (y)))").value("z") == 2


@pytest.mark.parametrize(
    ("precondition", "applicable"),
    [
        ("(> (z) 0)", False),
        ("(not (> (z) 0))", False),
        ("(or (p) (> (z) 0))", True),
        ("(and (p) (not (> (z) 0)))", False),
        ("(imply (> (z) 0) (q))", False),
        ("(imply (> (z) 0) (p))", True),
        ("(= (/ (x) (- (y) 2)) 1)", False),
        ("(>= (* 0.1 (x)) 0.3)", True),
        ("(forall (?o) (q))", True),
        ("(exists (?o) (p))", False),
    ],
)
def test_comparisons_of_undefined_numbers_are_neither_true_nor_false(precondition, applicable):
    task = task_with("(q)", precondition=precondition)
    assert (task.applicable(task.initial_state) == ("(a)",)) is applicable
    assert (Planner(task).solve().status == "optimal") is applicable
