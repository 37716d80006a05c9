"""What is kept of an episode: the agreed keys, plain JSON, on the disk at once."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.experiments import episode_record as mut

KEYS = [
    "episode",
    "task",
    "profile",
    "seed",
    "success",
    "failure",
    "actions",
    "plan_variant",
    "plan_cost",
    "replans",
    "features",
    "predicted_features",
    "ratings",
    "weights_before",
    "weights_after",
    "weights_std",
    "distance_to_true",
    "sim_time_s",
    "solver",
    "mpc_solves",
    "mpc_failures",
    "mpc_not_converged",
    "min_clearance_m",
    "collisions",
    "terminal_errors_m",
    "terminal_yaw_errors_rad",
    "terminal_speeds_m_s",
    "mismatches",
    "battery_start",
    "battery_end",
    "timing",
]
TIMING_KEYS = ["wall_s", "cpu_s", "mpc_median_ms", "mpc_p95_ms", "mpc_max_ms", "plan_median_ms", "plan_p95_ms"]


def refuse_constants(name):
    raise AssertionError(f"{name} is not JSON")


def strict(text):
    """Reads JSON as other languages do, without NaN and Infinity."""
    return json.loads(text, parse_constant=refuse_constants)


def test_the_keys_are_the_agreed_ones_and_no_others(episode_record):
    written = strict(episode_record().to_json())
    assert sorted(written) == sorted(KEYS)
    assert list(written["timing"]) == TIMING_KEYS
    assert list(written["features"]) == ["time", "safety", "battery", "proximity", "approach"]


def test_learned_dynamics_are_written_where_they_are_learned(episode_record):
    learned = {
        "learned_dynamics": {"yaw_coupling": [0.31, 0.01]},
        "dynamics_errors": {"nominal": [0.004, 0.002, 0.01], "learned": [0.002, 0.001, 0.002]},
    }
    written = strict(episode_record(**learned).to_json())
    assert sorted(written) == sorted([*KEYS, *learned])
    assert {name: written[name] for name in learned} == learned


def test_learned_weights_are_written_where_they_are_learned(episode_record):
    learned = {"learned_weights": {"pantry": [1.5, 1.0, 0.8, 0.9]}, "learned_translation": [[2.0, 0.0, 0.0, 0.0, 0.0]]}
    written = strict(episode_record(**learned).to_json())
    assert sorted(written) == sorted([*KEYS, *learned])
    assert {name: written[name] for name in learned} == learned


def test_executed_actions_are_written_before_the_timing(episode_record):
    entry = {"action": "(recharge robot1)", "outcome": "success", "external_reward": -0.1, "closed_loop_cost": None}
    written = strict(episode_record(executed_actions=[entry]).to_json())
    assert sorted(written) == sorted([*KEYS, "executed_actions"])
    assert written["executed_actions"] == [entry]
    assert list(written).index("executed_actions") == list(written).index("timing") - 1


def test_legs_to_displaced_places_are_written_where_there_are_some(episode_record):
    leg = {"place": "pantry", "outcome": "success", "mismatch": 0.25, "moved": True, "x": -3.0}
    written = strict(episode_record(displaced_legs=[leg]).to_json())
    assert sorted(written) == sorted([*KEYS, "displaced_legs"])
    assert written["displaced_legs"] == [leg]


def test_a_record_is_one_line(episode_record):
    assert len(episode_record(failure="no\nplan\u2028exists").to_json().split("\n")) == 1


def test_numbers_that_json_lacks_become_null(episode_record):
    line = episode_record(min_clearance_m=math.inf, plan_cost=math.nan, terminal_errors_m=[math.inf, 1.0]).to_json()
    written = strict(line)
    assert written["min_clearance_m"] is None
    assert written["plan_cost"] is None
    assert written["terminal_errors_m"] == [None, 1.0]


numbers = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text())


@given(st.recursive(numbers, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20))
def test_any_value_becomes_json_that_reads_back_as_it_was(value):
    plain = mut.plain(value)
    assert strict(json.dumps(plain)) == plain


@given(st.floats(min_value=-1e6, max_value=1e6))
def test_rounding_loses_less_than_a_nanometre(value):
    assert mut.plain(value) == pytest.approx(value, abs=1e-9)


def test_an_episode_is_rated_by_a_single_rating(episode_record):
    assert episode_record().rated
    assert episode_record(ratings=[None, None, 3.0, None, None]).rated
    assert not episode_record(ratings=[None] * 5).rated


def test_timing_is_in_milliseconds_and_nothing_without_solves():
    times = mut.timing(wall_seconds=2.0, cpu_seconds=1.5, mpc_seconds=[0.001, 0.002, 0.009], plan_seconds=[])
    assert times["wall_s"] == 2.0
    assert times["mpc_median_ms"] == pytest.approx(2.0)
    assert times["mpc_max_ms"] == pytest.approx(9.0)
    assert times["mpc_median_ms"] < times["mpc_p95_ms"] <= times["mpc_max_ms"]
    assert times["plan_median_ms"] == times["plan_p95_ms"] == 0.0


@pytest.mark.parametrize(
    ("actions", "variant"),
    [
        ([], "none/none/none/none"),
        (["(go_to_pharmacy_north robot1 home)"], "north/none/none/none"),
        (
            [
                "(go_to_pharmacy_north robot1 home)",
                "(collect_med_antibiotic robot1 pharmacy_north)",
                "(go_to_supply_a robot1 pharmacy_north)",
                "(collect_supp_vitamin_d robot1 supply_a)",
                "(approach_right_to_bed robot1 supply_a)",
                "(deliver_on_bedside_table_right robot1)",
            ],
            "north/A/med-supp/right",
        ),
        (
            [
                "(go_to_supply_b robot1 home)",
                "(collect_supp_vitamin_d robot1 supply_b)",
                "(go_to_charge_main robot1 supply_b)",
                "(go_to_pharmacy_north robot1 charge_main)",
                "(go_to_pharmacy_south robot1 charge_main)",
                "(collect_med_insulin robot1 pharmacy_south)",
                "(collect_med_antibiotic robot1 pharmacy_south)",
                "(approach_left_to_bed robot1 pharmacy_south)",
            ],
            "south/B/supp-med/left",
        ),
    ],
)
def test_a_plan_variant_is_read_from_what_was_executed(actions, variant):
    assert mut.plan_variant(actions) == variant


def test_each_record_is_on_the_disk_before_the_file_is_closed(tmp_path, episode_record):
    file = mut.EpisodeFile(tmp_path / "new" / "folder")
    for episode in range(3):
        file.append(episode_record(episode=episode))
        lines = file.path.read_text(encoding="utf-8").splitlines()
        assert [strict(line)["episode"] for line in lines] == list(range(episode + 1))
    file.close()


def test_an_episode_that_the_disk_has_no_room_for_is_told_in_one_line(tmp_path, episode_record):
    (tmp_path / "episodes.jsonl").symlink_to("/dev/full")
    file = mut.EpisodeFile(tmp_path)
    with pytest.raises(BadInput, match=r"episodes\.jsonl: cannot be written \(No space left on device\)"):
        file.append(episode_record())
    file.close()


def test_a_new_file_replaces_an_earlier_one(tmp_path):
    (tmp_path / "episodes.jsonl").write_text("old\n")
    mut.EpisodeFile(tmp_path).close()
    assert (tmp_path / "episodes.jsonl").read_text() == ""


def test_looking_whether_a_file_can_be_written_leaves_it_as_it_is(tmp_path):
    kept = tmp_path / "kept.txt"
    kept.write_text("kept")
    mut.check_writable(kept)
    mut.check_writable(tmp_path / "new" / "file.txt")
    assert kept.read_text() == "kept"
    assert list((tmp_path / "new").iterdir()) == []


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match=r"file.below.*folder"):
        mut.check_writable(tmp_path / "file" / "below")
    with pytest.raises(BadInput, match="is a folder"):
        mut.check_writable(tmp_path)


def test_a_file_without_permission_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(mut.os, "access", lambda *_: False)
    with pytest.raises(BadInput, match="permission denied"):
        mut.check_writable(tmp_path / "file")


@pytest.mark.parametrize(
    ("names", "variant"),
    [
        (("choose_salad", "go_to_pantry", "approach_to_left_side", "deliver_on_bedside_table_left"), "salad/left"),
        (("choose_sandwich", "choose_hot_meal", "approach_to_left_side", "approach_to_right_side"), "hot_meal/right"),
        (("choose_sandwich", "collect_ingredient"), "sandwich/none"),
        ((), "none/none"),
    ],
)
def test_the_variant_of_a_meal_is_its_dish_and_the_bedside(names, variant):
    assert mut.plan_variant([f"({name} robot1)" for name in names], "meal") == variant
