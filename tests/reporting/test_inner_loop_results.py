"""Single actions and what the controller learned, from records that are known by heart."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.reporting import inner_loop_results as mut
from mala_drake.reporting.results import load_results


@pytest.fixture(scope="module")
def results(tmp_path_factory, simulate_results, with_learned_control):
    folder = tmp_path_factory.mktemp("inner")
    simulate_results(folder, profiles=("speed_oriented",), episodes=3)
    simulate_results(folder, profiles=("speed_oriented",), episodes=3, condition="learned", change=with_learned_control)
    return load_results(folder)


@pytest.fixture
def run(results):
    return results.of("learned")[0]


@pytest.mark.parametrize(
    ("action", "kind"),
    [
        ("(approach_to_left_side robot1 quality_check)", mut.APPROACH),
        ("(go_to_charge_main robot1 pantry)", mut.DRIVE),
        ("(recharge robot1)", mut.WORK),
    ],
)
def test_actions_are_of_three_kinds(action, kind):
    assert mut.kind_of(action) == kind


def test_means_are_over_the_actions_that_tell(run):
    first, second, _ = run.episodes
    assert mut.values_of(first, "closed_loop_cost") == [40.0, 60.0]
    assert mut.mean_size(first, "cost_mismatch") == pytest.approx((0.002 + 0.0001 + 0.006) / 4)
    assert mut.mean_size(second, "cost_mismatch", mut.APPROACH) == pytest.approx(0.003)
    assert mut.mean_size(first, "cost_mismatch", mut.WORK) == pytest.approx(0.00005)


def test_what_earlier_versions_wrote_tells_nothing(results):
    (old, *_) = results.of(results.main)
    assert not mut.has_actions(results, results.main)
    assert mut.has_actions(results, "learned")
    assert math.isnan(mut.mean_size(old.final, "cost_mismatch"))
    assert mut.error_ratios(old) == ()
    assert list(mut.coefficient_course(old, "yaw_gain", 1.0))[-1][0] == 1.0


def test_numbers_that_json_lacks_are_left_out(run):
    entries = [{**entry, "cost_mismatch": None} for entry in run.final.executed_actions]
    assert mut.values_of(replace(run.final, executed_actions=entries), "cost_mismatch") == []


def test_the_condition_that_learns_is_found_where_it_is_not_the_main_one(results):
    assert mut.learning_condition(results, "learned_dynamics") == "learned"
    assert mut.under(results, "learned") == " Learned under learned."
    assert mut.under(results, results.main) == ""
    assert mut.learning_condition(results, "displaced_legs") is None


def test_courses_begin_before_the_first_episode(run):
    values, deviations = zip(*mut.coefficient_course(run, "lateral_damping", 5.0), strict=True)
    assert values == (5.0, 6.0, 7.0, 8.0)
    assert math.isnan(deviations[0])
    assert deviations[1:] == pytest.approx((0.02, 0.01, 0.02 / 3))
    assert mut.factor_course(run, "patient_bed_left", 2) == [1.0, 1.0, 4.0, 8.0]
    assert mut.factor_course(run, "pantry", 2) == [1.0] * 4
    start = float(DEFAULT_TRANSLATION.gains[2, 4])
    assert mut.gain_course(run, 2, 4, start) == pytest.approx([0.0, 0.0, 0.02, 0.03])


def test_places_are_those_that_something_was_learned_of(results):
    assert mut.factor_places(results, "learned") == ("patient_bed_left",)


def test_errors_are_compared_in_the_last_episode(run):
    assert mut.error_ratios(run) == pytest.approx((0.5, 0.5, 1 / 12))
