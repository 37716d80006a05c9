"""The heuristic never promises more than a plan costs, on random tasks too, and A* with it finds the optimum."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.planning.landmark_cut as mut
from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model
from mala_drake.planning.search import best_first

FACTS = [f"(f{index})" for index in range(6)]
literal = st.tuples(st.sampled_from(FACTS), st.booleans()).map(lambda pair: pair[0] if pair[1] else f"(not {pair[0]})")
cost = st.sampled_from(["0", "1", "2", "0.75"]).map(lambda number: f"(increase (total-cost) {number})")


@st.composite
def random_tasks(draw):
    actions = []
    for index in range(draw(st.integers(3, 8))):
        needs = draw(st.lists(literal, max_size=3))
        does = [*draw(st.lists(literal, min_size=1, max_size=3)), draw(cost)]
        if draw(st.booleans()):
            does.append(f"(when {draw(literal)} (and {draw(literal)} {draw(cost)}))")
        actions.append(f"(:action a{index} :precondition (and {' '.join(needs)}) :effect (and {' '.join(does)}))")
    start = " ".join(draw(st.lists(st.sampled_from(FACTS), max_size=2)))
    goal = " ".join(draw(st.lists(literal, min_size=1, max_size=4)))
    return PlanningTask.parse(
        f"(define (domain d) (:predicates {' '.join(FACTS)}) (:functions (total-cost)) {' '.join(actions)})",
        f"(define (problem p) (:domain d) (:init {start}) (:goal (and {goal})) (:metric minimize (total-cost)))",
    )


def search_space(task, state=None):
    state = state or task.initial_state
    grounding = task.grounding(state)
    model = Model(grounding.operators, grounding.table, state.values)
    return model, (grounding.operators.mask(state.facts), model.numbers.initial())


@settings(max_examples=150, deadline=None)
@given(random_tasks())
def test_never_more_than_the_cost_and_never_the_wrong_plan(task):
    model, start = search_space(task)
    if model.task.goal is None:
        return
    truth = best_first(model, start, budget=Budget())
    heuristic = mut.LandmarkCut(model)
    found = best_first(model, start, heuristic=heuristic, budget=Budget())
    if truth is None:
        assert found is None
        return
    assert found is not None
    assert found.cost == truth.cost
    assert heuristic(start) <= truth.cost


@pytest.mark.parametrize(("name", "least"), [("logistics", 12), ("gripper", 9), ("blocks", 10)])
def test_is_informed_where_blind_search_is_not(load, name, least):
    # In gripper every ball must be picked up and dropped and the robot must move: 9 of 11. Nearly all of the other two.
    task = load(name)
    model, start = search_space(task)
    value = model.numbers.exact(mut.LandmarkCut(model)(start))
    assert least <= value <= Planner(task).solve().cost


def test_no_way_left_is_told(load):
    task = load("logistics")
    model, _ = search_space(task)
    stranded = task.initial_state.with_facts(remove=["(at jet r-airport)"])
    assert mut.LandmarkCut(model)((model.task.mask(stranded.facts), ())) is None


def test_larger_tasks_are_solved_with_few_expansions(request):
    domain = (request.path.parent.parent / "data" / "pddl" / "blocks-domain.pddl").read_text()
    pairs = list(zip("abcdefg", "bcdefgh", strict=True))
    problem = f"""(define (problem p) (:domain blocks) (:objects {" ".join("abcdefgh")} - block)
      (:init {" ".join(f"(on {x} {y})" for x, y in pairs)} (clear a) (on-table h) (arm-empty))
      (:goal (and {" ".join(f"(on {y} {x})" for x, y in pairs)})))"""
    plan = Planner(PlanningTask.parse(domain, problem)).solve(max_expansions=2000)
    assert (plan.status, plan.cost) == ("optimal", 16)


def test_time_is_looked_at_before_each_cut_and_once_more():
    task = PlanningTask.parse(
        """(define (domain d) (:predicates (f) (g) (h))
          (:action a :effect (f)) (:action b :precondition (f) :effect (g))
          (:action c :precondition (g) :effect (h)))""",
        "(define (problem p) (:domain d) (:goal (h)))",
    )
    model, start = search_space(task)
    ticks = []
    heuristic = mut.LandmarkCut(model, lambda: ticks.append(1))
    assert model.numbers.exact(heuristic(start)) == 3
    assert len(ticks) == 3 + 1
