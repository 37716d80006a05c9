"""What is said of actions and of the controller's learning."""

from __future__ import annotations

from mala_drake.reporting import inner_loop_findings as mut
from mala_drake.reporting.results import load_results


def load(folder, simulate_results, change, **more):
    simulate_results(folder, profiles=("speed_oriented",), episodes=3, change=change, **more)
    return load_results(folder)


def test_actions_are_told_task_by_task(tmp_path, simulate_results, with_actions):
    results = load(tmp_path, simulate_results, lambda record: with_actions(record, wrong_items=(1,)))
    meaning, medication, states = mut.inner_loop_sentences(results)
    assert "not the patient's own rating" in meaning
    assert medication == (
        "Medication: on average an action cost 2.0 thousandths more or less than predicted in the first episode and "
        "0.51 in the last (medians over runs)."
    )
    assert states == "After 22 of 24 actions E^ψ was 0: all was as expected."


def test_what_the_controller_learned_is_told(tmp_path, simulate_results, with_learned_control):
    results = load(tmp_path, simulate_results, with_learned_control)
    assert mut.inner_loop_sentences(results)[3:] == (
        "A tick ahead, the learned model's errors are 0.50 (forward), 0.50 (sideways) and 0.08 (turning) times those "
        "of the nominal model in the last episode (medians).",
        "The controller's weights were learned for drives to 1 place; farthest from 1 at the end is that of velocity "
        "for patient bed left, at 8.00.",
        "No gain from preferences to the controller's weights has moved by more than 0.03.",
    )


def test_another_condition_is_named(tmp_path, simulate_results, with_learned_control):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    results = load(tmp_path, simulate_results, with_learned_control, condition="learned")
    told = mut.inner_loop_sentences(results)
    assert len(told) == 3
    assert all(sentence.startswith("Under learned: ") for sentence in told)


def test_nothing_is_said_of_what_nobody_wrote(tmp_path, simulate_results):
    assert mut.inner_loop_sentences(load(tmp_path, simulate_results, None)) == ()


def test_thousandths_have_two_digits():
    assert [mut.thousandths(value) for value in (0.00123, 0.0002, 0.0124)] == ["1.2", "0.20", "12"]
