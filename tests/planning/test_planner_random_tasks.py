"""Plans of random tasks are optimal: a brute force agrees.

The brute force knows nothing of grounding, search or metrics: it walks the states by name and relaxes distances, with
`cost` the one fluent that nothing reads.
"""

import itertools
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.planning.planner as mut
from mala_drake.errors import BadInput
from mala_drake.planning import PlanningTask, validate_plan

FACTS = ("p", "q")
literal = st.tuples(st.sampled_from(FACTS), st.booleans()).map(
    lambda pair: f"({pair[0]})" if pair[1] else f"(not ({pair[0]}))"
)
comparison = st.tuples(
    st.sampled_from([">=", "<=", "=", ">", "<"]), st.sampled_from(["x", "y"]), st.integers(0, 3)
).map(lambda parts: f"({parts[0]} ({parts[1]}) {parts[2]})")
plain = st.one_of(literal, comparison)
condition = st.one_of(
    plain,
    st.tuples(plain, plain).map(lambda pair: f"(or {pair[0]} {pair[1]})"),
    st.tuples(plain, plain).map(lambda pair: f"(imply {pair[0]} {pair[1]})"),
)
bounded = st.sampled_from(
    [
        "(when (< (x) 3) (increase (x) 1))",
        "(when (> (x) 0) (decrease (x) 1))",
        "(when (< (y) 3) (increase (y) 1.5))",
        "(assign (y) 0)",
        "(assign (x) 2)",
        "(assign (y) (x))",
    ]
)


@st.composite
def random_tasks(draw, *, negative):
    actions = []
    costs = st.sampled_from(["0", "1", "0.5", "2.25", "(x)", "(* 0.5 (y))"] + (["-1", "(- (x))"] if negative else []))
    for index in range(draw(st.integers(2, 4))):
        needs = " ".join(draw(st.lists(condition, max_size=2)))
        does = draw(st.lists(st.one_of(literal, bounded), min_size=1, max_size=3))
        does += [
            f"(when {draw(condition)} {draw(st.one_of(literal, bounded))})" for _ in range(draw(st.integers(0, 2)))
        ]
        does.append(f"(increase (cost) {draw(costs)})")
        if draw(st.booleans()):
            does.append(f"(when {draw(condition)} (increase (cost) {draw(costs)}))")
        actions.append(f"(:action a{index} :precondition (and {needs}) :effect (and {' '.join(does)}))")
    metric = draw(
        st.sampled_from(
            ["", "minimize (cost)", "minimize (+ (* 2 (cost)) (x))", "minimize (* 0.5 (+ (cost) (* (x) (y))))"]
            + (["maximize (+ (x) (y))", "maximize (- (x) (cost))", "minimize (/ (y) (x))"] if negative else [])
        )
    )
    start = [f"({fact})" for fact in FACTS if draw(st.booleans())]
    goal = " ".join(draw(st.lists(condition, min_size=1, max_size=2)))
    domain = "(define (domain d) (:predicates (p) (q)) (:functions (x) (y) (cost))" + "\n".join(actions) + ")"
    problem = (
        f"(define (problem p) (:domain d) (:init {' '.join(start)} (= (x) {draw(st.integers(0, 2))}) (= (y) 0.5)"
        f" (= (cost) 0)) (:goal (and {goal})) {f'(:metric {metric})' if metric else ''})"
    )
    return domain, problem


def brute_force(task):
    """The best metric over all plans, None if there is no plan, "unbounded" if there is no best one."""
    metric = task.description.metric
    names = [f"({schema.name})" for schema in task.description.actions]

    def key(state):
        return state.facts, state.value("x"), state.value("y")

    start = task.initial_state
    states = {key(start): start}
    edges = []
    queue = [start]
    for state in queue:
        for name in names:
            try:
                after = task.apply(state, name)
            except ValueError:
                continue
            edges.append((key(state), key(after), after.value("cost") - state.value("cost")))
            if key(after) not in states:
                states[key(after)] = after
                queue.append(after)
    goals = {each for each, state in states.items() if task.is_goal(state)}
    sign = -1 if metric is not None and not metric.minimize else 1
    # How much one unit of cost adds to the metric, from two states that differ in it alone.
    slopes = {}
    for each in goals:
        values = [task.metric_value(states[each].with_fluents({"cost": amount})) for amount in (0, 1)]
        if metric is None:
            slopes[each] = (Fraction(0), Fraction(1))
        elif None not in values:
            slopes[each] = (sign * values[0], sign * (values[1] - values[0]))
    if not slopes:
        return "undefined" if goals else None
    slope = next(iter(slopes.values()))[1]
    steps = [(a, b, Fraction(1) if metric is None else slope * cost) for a, b, cost in edges]
    useful: set = set()
    more = set(slopes)
    while more:
        useful |= more
        more = {a for a, b, _ in steps if b in useful} - useful
    distance = {key(start): Fraction(0)}
    for round_number in itertools.count():
        changed = False
        for a, b, cost in steps:
            if a in distance and b in useful and (b not in distance or distance[a] + cost < distance[b]):
                distance[b] = distance[a] + cost
                changed = True
        if not changed:
            break
        if round_number > len(states):
            return "unbounded"
    return sign * min(distance[each] + slopes[each][0] for each in slopes if each in distance)


def task_assigns_metric(task):
    """Whether an action mentions x or y as a target, so that the metric may become defined on the way."""
    return any(f"fluent=Fluent(name='{name}'" in repr(task.description.actions) for name in "xy")


def check_against_brute_force(texts):
    task = PlanningTask.parse(*texts)
    truth = brute_force(task)
    for search in ("astar", "ucs"):
        if truth == "unbounded":
            with pytest.raises(BadInput, match="no plan is optimal"):
                mut.Planner(task, search).solve()
            continue
        if truth == "undefined" and task.metric_value(task.initial_state) is None and not task_assigns_metric(task):
            with pytest.raises(BadInput, match="undefined for every plan"):
                mut.Planner(task, search).solve()
            continue
        truth = None if truth == "undefined" else truth
        plan = mut.Planner(task, search).solve()
        assert plan.status == ("unsolvable" if truth is None else "optimal")
        assert plan.cost == truth
        if truth is not None:
            verdict = validate_plan(task, plan.actions)
            assert verdict.valid, verdict.reason
            assert verdict.cost == truth


@settings(max_examples=100, deadline=None)
@given(random_tasks(negative=False))
def test_random_tasks_are_solved_optimally(texts):
    check_against_brute_force(texts)


@settings(max_examples=100, deadline=None)
@given(random_tasks(negative=True))
def test_random_tasks_with_gains_are_solved_optimally_or_refused(texts):
    check_against_brute_force(texts)
