"""The tables of a report, cell by cell, against figures counted by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mala_drake.reporting import result_tables as mut
from mala_drake.reporting.quantiles import Spread
from mala_drake.reporting.results import load_results


@pytest.mark.parametrize(
    ("figures", "text"),
    [
        (Spread(1.0, 1.0, 1.0), "1"),
        (Spread(2.0, 1.0, 3.5), "2 (1–3.5)"),
        (Spread(10.0, 2.0, math.inf), "10 (2–never)"),
        (Spread(math.inf, math.inf, math.inf), "never"),
        (Spread(math.nan, math.nan, math.nan), "–"),
    ],
)
def test_counts_have_a_decimal_only_where_there_is_something_behind_it(figures, text):
    assert mut.counts(figures) == text


def test_only_all_is_a_hundred_percent():
    assert mut.percent(1000, 1000) == "100 %"
    assert mut.percent(9999, 10000) == "99.9 %"
    assert mut.percent(1, 2) == "50 %"
    assert mut.percent(0, 3) == "0 %"


def set_distance(distances):
    def change(record):
        return replace(record, distance_to_true=distances[record.seed][record.episode], plan_variant="p")

    return change


@pytest.fixture
def two_learners(tmp_path, simulate_results):
    ours = set_distance({0: [0.1, 0.02], 1: [0.2, 0.04]})
    papers = set_distance({0: [0.3, 0.2], 1: [0.3, 0.1]})
    one = {"profiles": ("speed_oriented",), "episodes": 2}
    simulate_results(tmp_path, **one, change=ours)
    simulate_results(tmp_path, **one, change=papers, condition="projected_gradient")
    simulate_results(tmp_path, **one, change=papers, condition="bandit")
    return load_results(tmp_path)


def test_ours_the_papers_learner_and_the_paper_stand_beside_each_other(two_learners):
    profile, total = mut.convergence_table(two_learners).groups
    assert (profile.title, total.title) == ("Speed oriented", "All")
    assert [row[:5] for row in profile.rows] == [
        ("main", "2/2", "1.5 (1.2–1.8)", "0.030 (0.025–0.035)", "0.030 (0.025–0.035)"),
        (
            "projected gradient",
            "1/2",
            "never",
            "0.150 (0.125–0.175)",
            "0.150 (0.125–0.175)",
        ),
        ("paper", "5/5", "2", "0.023 ± 0.008", "0.043"),
    ]
    assert profile.rows[2][6:] == ("3 or 4", "100 %", "–")
    assert [row[0] for row in total.rows] == ["main", "projected gradient"]


def test_every_condition_has_a_row(two_learners):
    table = mut.condition_table(two_learners)
    assert table is not None
    rows = [row for group in table.groups for row in group.rows]
    assert [row[:3] for row in rows] == [
        ("main", "2", "2/2"),
        ("bandit", "2", "1/2"),
        ("projected gradient", "2", "1/2"),
    ]


def test_a_condition_in_which_nothing_was_done_has_no_cost(tmp_path, simulate_results):
    def fail(record):
        return replace(record, success=False, failure="blocked")

    one = {"profiles": ("speed_oriented",), "episodes": 2}
    simulate_results(tmp_path, **one)
    simulate_results(tmp_path, **one, change=fail, condition="bandit")
    table = mut.condition_table(load_results(tmp_path))
    main, bandit = (dict(zip(table.headings, group.rows[0], strict=True)) for group in table.groups)
    assert main["cost"] != mut.NONE
    assert bandit["cost"] == mut.NONE


def test_after_a_change_of_mind_the_final_distances_and_the_caption_are_of_what_is_wanted_now(two_learners):
    changed = replace(two_learners, runs=tuple(replace(run, earlier_episodes=2) for run in two_learners.runs[-2:]))
    both = replace(two_learners, runs=(*two_learners.runs[:-2], *changed.runs))
    table = mut.condition_table(both)
    last = dict(zip(table.headings, table.groups[1].rows[-1], strict=True))
    assert (last["converged"], last["final d"], last["cost"]) == ("0/2", mut.NONE, mut.NONE)
    assert "changes its mind" in table.caption
    assert "changes its mind" in mut.convergence_table(both).caption
    assert "changes its mind" not in mut.condition_table(two_learners).caption
    assert "changes its mind" not in mut.convergence_table(two_learners).caption


def test_one_condition_needs_no_table_of_conditions(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",))
    assert mut.condition_table(load_results(tmp_path)) is None


def test_times_are_medians_over_episodes(tmp_path, simulate_results):
    def take(record):
        return replace(record, timing={"wall_s": 1.0 + record.episode, "plan_p95_ms": 2.0})

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=3, change=take)
    table = mut.timing_table(load_results(tmp_path))
    assert table is not None
    assert table.groups[0].rows == (
        ("wall, s an episode", "2", "1.5", "2.5", "3"),
        ("plan p95, ms", "2", "2", "2", "2"),
    )


def test_times_that_are_not_told_make_no_table(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), change=lambda record: replace(record, timing={}))
    assert mut.timing_table(load_results(tmp_path)) is None


def test_the_worst_of_all_episodes_is_told(tmp_path, simulate_results):
    def drive(record):
        if record.episode == 1:
            return replace(
                record,
                min_clearance_m=0.1,
                terminal_errors_m=[0.01, None, 0.3],
                terminal_yaw_errors_rad=[-0.2],
                terminal_speeds_m_s=[],
                mpc_failures=2,
                mpc_not_converged=5,
                mismatches=1,
                sim_time_s=1800.0,
            )
        return replace(record, sim_time_s=1800.0, min_clearance_m=math.inf, terminal_speeds_m_s=[0.04])

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=2, change=drive)
    ((row,),) = [group.rows for group in mut.execution_table(load_results(tmp_path)).groups]
    assert row == ("main", "2", "0.100", "0.300", "0.200", "0.040", "500", "2", "5", "1", "1.0")


def test_what_earlier_versions_counted_among_failures_is_left_open(tmp_path, simulate_results):
    def forget(record):
        return replace(record, mpc_not_converged=None)

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=2, change=forget)
    table = mut.execution_table(load_results(tmp_path))
    assert table.groups[0].rows[0][table.headings.index("stopped early")] == mut.NONE
