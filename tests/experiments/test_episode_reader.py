"""Reading episodes back: what was written is what is read."""

from __future__ import annotations

import dataclasses
import json
import math

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import episode_reader as mut
from mala_drake.experiments.episode_record import EpisodeRecord


def test_records_come_back_with_everything_that_is_in_the_file(tmp_path, episode_record):
    written = [
        episode_record(),
        episode_record(episode=1, success=False, failure="no way", ratings=[None] * 5, plan_cost=math.nan),
        episode_record(episode=2, learned_dynamics={"yaw_coupling": [0.31, 0.01]}),
    ]
    learned = {"learned_weights": {"pantry": [1.5, 1.0, 0.8, 0.9]}, "learned_translation": [[2.0] * 5] * 9}
    written.append(episode_record(episode=4, **learned))
    entry = {"action": "(recharge robot1)", "closed_loop_cost": None, "cost_mismatch": 0.01}
    written.append(episode_record(episode=5, executed_actions=[entry]))
    written.append(episode_record(episode=6, terminal_errors_m=[0.01, None]))
    (tmp_path / "file").write_text("".join(record.to_json() + "\n" for record in written))
    records, torn = mut.read_episodes(tmp_path / "file")
    assert not torn
    assert [record.to_json() for record in records] == [record.to_json() for record in written]
    assert math.isnan(records[1].plan_cost)
    assert records[2].learned_dynamics == {"yaw_coupling": [0.31, 0.01]}
    assert records[2].executed_actions is None
    assert (records[3].learned_weights, records[3].learned_translation) == tuple(learned.values())
    assert records[4].executed_actions == [entry]
    assert records[5].terminal_errors_m == [0.01, None]


def test_a_line_of_an_earlier_version_does_not_tell_solves_that_stopped_early(tmp_path, episode_record):
    line = json.loads(episode_record(mpc_failures=3).to_json())
    del line["mpc_not_converged"]
    (tmp_path / "file").write_text(json.dumps(line) + "\n")
    ((record,), _) = mut.read_episodes(tmp_path / "file")
    assert (record.mpc_failures, record.mpc_not_converged) == (3, None)
    assert json.loads(record.to_json()) == line


@pytest.mark.parametrize("wrong", ["many", 1.5, True])
def test_a_number_that_may_be_missing_is_a_number_where_it_is_not(tmp_path, episode_record, wrong):
    line = json.loads(episode_record().to_json())
    (tmp_path / "file").write_text(json.dumps({**line, "mpc_not_converged": wrong}) + "\n")
    with pytest.raises(BadInput, match=r"mpc_not_converged: .* a whole number"):
        mut.read_episodes(tmp_path / "file")


LEG = {"place": "pantry", "outcome": "success", "mismatch": 0, "moved": True, "x": 1, "y": 2, "distance_to_true_m": 0}


@pytest.mark.parametrize(
    ("field", "wrong", "told"),
    [
        ("features", {}, "features: {}; expected an object with time, safety, battery, proximity, approach"),
        ("features", {"time": 1}, 'features: {"time": 1}; expected an object with time, safety'),
        ("weights_after", [0.5, 0.5], "weights_after: [0.5, 0.5]; expected a list of 5"),
        ("ratings", [3.0] * 4 + ["good"], 'ratings[4]: "good"; expected a finite number'),
        ("timing", {"wall": 1}, 'timing: "wall"; expected a name that ends in _s or _ms'),
        ("timing", 3, "timing: 3; expected an object"),
        ("actions", [""], 'actions[0]: ""; expected (name object ...)'),
        ("actions", ["()"], 'actions[0]: "()"; expected (name object ...)'),
        ("executed_actions", [{}], "executed_actions[0]: {}; expected an object with action"),
        ("executed_actions", [{"action": "(go)", "cost_mismatch": "x"}], 'executed_actions[0].cost_mismatch: "x"'),
        ("displaced_legs", [{}], "displaced_legs[0]: {}; expected an object with place, outcome, mismatch, moved"),
        ("displaced_legs", [{**LEG, "x": None}], "displaced_legs[0].x: null; expected a finite number"),
        ("displaced_legs", None, "displaced_legs: null; expected a list"),
        ("learned_dynamics", {"yaw_gain": [0.3]}, "learned_dynamics.yaw_gain: [0.3]; expected a list of 2"),
        ("dynamics_errors", {"nominal": [1, 2]}, "dynamics_errors.nominal: [1, 2]; expected a list of 3"),
        ("learned_weights", {"pantry": [1, 0, 1, 1]}, "learned_weights.pantry[1]: 0; expected a number above 0"),
        (
            "learned_translation",
            [[1.0] * 5],
            "learned_translation: [[1.0, 1.0, 1.0, 1.0, 1.0]]; expected a list of 0 or 9",
        ),
        ("sim_time_s", 10**400, "expected a finite number"),
        ("success", 1, "success: 1; expected true or false"),
    ],
)
def test_a_value_that_no_episode_has_is_told_by_file_line_field_and_what_was_expected(
    tmp_path, episode_record, field, wrong, told
):
    line = json.loads(episode_record().to_json())
    (tmp_path / "file").write_text("".join(json.dumps(each) + "\n" for each in (line, {**line, field: wrong})))
    with pytest.raises(BadInput) as caught:
        mut.read_episodes(tmp_path / "file")
    assert str(caught.value).startswith(f"{tmp_path / 'file'}, line 2: {field}")
    assert told in str(caught.value)
    assert len(str(caught.value)) < 300 + len(str(tmp_path))


def test_every_field_of_a_record_that_is_in_the_file_is_known_to_the_reader():
    fields = {field.name for field in dataclasses.fields(EpisodeRecord)}
    assert set(mut._FIELDS) == fields - {"leg_outcomes"}


def test_keys_that_a_newer_version_has_added_are_no_mistake(tmp_path, episode_record):
    line = json.loads(episode_record(displaced_legs=[{**LEG, "new": []}]).to_json())
    (tmp_path / "file").write_text(json.dumps({**line, "new": {}, "leg_outcomes": 3}) + "\n")
    ((record,), _) = mut.read_episodes(tmp_path / "file")
    assert record.displaced_legs == [{**LEG, "new": []}]
    assert record.leg_outcomes == []


def test_a_torn_last_line_is_left_out_and_told(tmp_path, episode_record):
    line = episode_record().to_json()
    (tmp_path / "file").write_text(line + "\n" + line[:50])
    records, torn = mut.read_episodes(tmp_path / "file")
    assert (len(records), torn) == (1, True)


@pytest.mark.parametrize(
    ("text", "words"), [("{\n{}\n", "line 1: is not JSON"), ("[]\n", "line 1: is not an object"), ("{}\n", "has no")]
)
def test_any_other_line_that_is_no_episode_is_told_in_one_line(tmp_path, text, words):
    (tmp_path / "file").write_text(text)
    with pytest.raises(BadInput, match=words):
        mut.read_episodes(tmp_path / "file")


def test_a_file_that_is_not_there_is_told_in_one_line(tmp_path):
    with pytest.raises(BadInput, match="cannot be read"):
        mut.read_episodes(tmp_path / "file")
