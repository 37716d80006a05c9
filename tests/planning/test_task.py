import pytest

from mala_drake.errors import BadInput
from mala_drake.planning import Planner, PlanningTask


def test_predicts_what_the_plan_says(load):
    task = load("care")
    plan = Planner(task).solve()
    state = task.initial_state
    for action in plan.actions:
        assert action in task.applicable(state)
        assert not task.is_goal(state)
        state = task.apply(state, action)
    assert task.is_goal(state)
    assert task.holds(state, "(delivered robot1)")
    assert task.metric_value(state) == plan.cost


def test_applicable_are_exactly_the_actions_that_apply(load):
    task = load("gripper")
    assert task.applicable(task.initial_state) == (
        "(move here there)",
        *(f"(pick b{ball} here {hand})" for ball in range(1, 5) for hand in ("left", "right")),
    )


def test_unknown_and_inapplicable_actions_are_told_apart(load):
    task = load("gripper")
    with pytest.raises(ValueError, match="precondition"):
        task.apply(task.initial_state, "(move there here)")
    with pytest.raises(BadInput, match="no such action"):
        task.apply(task.initial_state, "(fly here there)")


def test_missing_and_binary_files_are_refused(tmp_path):
    (tmp_path / "binary.pddl").write_bytes(b"\x7fELF\x00\xff\xfe")
    (tmp_path / "empty.pddl").write_text("; nothing\n")
    for name, words in (("none.pddl", "cannot be read"), ("binary.pddl", "not a text file"), ("empty.pddl", "empty")):
        with pytest.raises(BadInput, match=words) as caught:
            PlanningTask.load(tmp_path / name, tmp_path / name)
        assert name in str(caught.value)
    with pytest.raises(BadInput, match="cannot be read"):
        PlanningTask.load(tmp_path, tmp_path)


def test_groundings_are_kept_for_states_they_cover(load):
    task = load("logistics")
    first = task.grounding(task.initial_state)
    moved = task.apply(task.initial_state, "(drive p-truck p-airport p-office paris)")
    assert task.grounding(moved) is first
    fewer = task.initial_state.with_facts(remove=["(in-city r-office rome)"])
    assert len(task.grounding(fewer).operators.operators) < len(first.operators.operators)
    assert task.grounding(task.initial_state) is first
