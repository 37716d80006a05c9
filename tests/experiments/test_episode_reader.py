"""Reading episodes back: what was written is what is read."""

from __future__ import annotations

import json
import math

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import episode_reader as mut


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
    (tmp_path / "file").write_text("".join(record.to_json() + "\n" for record in written))
    records, torn = mut.read_episodes(tmp_path / "file")
    assert not torn
    assert [record.to_json() for record in records] == [record.to_json() for record in written]
    assert math.isnan(records[1].plan_cost)
    assert records[2].learned_dynamics == {"yaw_coupling": [0.31, 0.01]}
    assert records[2].executed_actions is None
    assert (records[3].learned_weights, records[3].learned_translation) == tuple(learned.values())
    assert records[4].executed_actions == [entry]


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
    with pytest.raises(BadInput, match=r"mpc_not_converged: .* a value of type int"):
        mut.read_episodes(tmp_path / "file")


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
