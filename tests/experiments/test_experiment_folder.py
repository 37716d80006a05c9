"""An experiment's folder: begun once, gone on with by whoever wants the same, and by one process at a time."""

from __future__ import annotations

import dataclasses
import json

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import experiment_folder as mut
from mala_drake.experiments.experiment import Experiment
from mala_drake.scenario import PatientConfig, Scenario

EXPERIMENT = Experiment(
    name="convergence",
    base=Scenario(episodes=3),
    conditions={"": {}, "noisy": {"patient": {"noise": 0.4}}},
    profiles=("safety_first",),
    seeds=(0, 1),
)


def begin(folder, experiment=EXPERIMENT, **options):
    with mut.experiment_folder(folder, experiment, **options):
        pass


def leave_results(folder):
    for run in EXPERIMENT.runs:
        (folder / run.folder).mkdir(parents=True, exist_ok=True)
        (folder / run.folder / "episodes.jsonl").write_text("{}\n")
    (folder / "summary.json").write_text("{}\n")


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("options", [{}, {"resume": True}, {"overwrite": True}])
def test_an_experiment_is_begun_where_there_is_nothing(tmp_path, options):
    begin(tmp_path / "new" / "results", **options)
    assert mut.begun_in(tmp_path / "new" / "results") == EXPERIMENT
    assert mut.begun_in(tmp_path) is None


def test_what_is_there_is_not_overwritten_unasked(tmp_path):
    begin(tmp_path)
    leave_results(tmp_path)
    before = files(tmp_path)
    with pytest.raises(BadInput, match=r"--resume .* --overwrite"):
        begin(tmp_path)
    assert files(tmp_path) == before


def test_to_go_on_leaves_the_episodes_and_drops_the_summary_of_before(tmp_path):
    begin(tmp_path)
    leave_results(tmp_path)
    begin(tmp_path, resume=True)
    assert all((tmp_path / run.folder / "episodes.jsonl").exists() for run in EXPERIMENT.runs)
    assert not (tmp_path / "summary.json").exists()


def test_to_overwrite_removes_the_results_and_nothing_else(tmp_path):
    begin(tmp_path)
    leave_results(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    other = dataclasses.replace(EXPERIMENT, seeds=(5,))
    begin(tmp_path, other, overwrite=True)
    assert mut.begun_in(tmp_path) == other
    assert list(tmp_path.rglob("episodes.jsonl")) == []
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_an_experiment_on_what_this_version_does_not_know_is_overwritten(tmp_path):
    begin(tmp_path)
    leave_results(tmp_path)
    told = json.loads((tmp_path / "experiment.json").read_text())
    told["scenario"] = {**told["scenario"], "of_another_version": 3}
    (tmp_path / "experiment.json").write_text(json.dumps({**told, "fingerprint": "0123456789abcdef"}))
    for options, words in ({"resume": True}, "--overwrite begins anew"), ({}, "or --overwrite"):
        with pytest.raises(BadInput, match=words):
            begin(tmp_path, **options)
    begin(tmp_path, overwrite=True)
    assert list(tmp_path.rglob("episodes.jsonl")) == []
    assert mut.begun_in(tmp_path) == EXPERIMENT


@pytest.mark.parametrize("options", [{}, {"resume": True}, {"overwrite": True}])
def test_a_folder_that_is_no_experiments_is_left_alone(tmp_path, options):
    (tmp_path / "episodes.jsonl").write_text("of a run")
    with pytest.raises(BadInput, match=r"episodes\.jsonl"):
        begin(tmp_path, **options)
    assert (tmp_path / "episodes.jsonl").read_text() == "of a run"
    assert not (tmp_path / "experiment.json").exists()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seeds": (0, 1, 2)}, r"seeds: \[0, 1, 2\]; expected \[0, 1\]"),
        ({"profiles": ("speed_oriented",)}, "profiles"),
        ({"base": Scenario(episodes=4)}, r"scenario\.episodes: 4; expected 3"),
        ({"base": Scenario(episodes=3, patient=PatientConfig(noise=0.2))}, r"scenario\.patient\.noise: 0\.2"),
        ({"conditions": {"": {}, "noisy": {"patient": {"noise": 0.5}}}}, r"conditions\.noisy\.patient\.noise: 0\.5"),
        ({"conditions": {"": {}}}, r"conditions\.noisy: null"),
        ({"name": "ablations"}, "experiment"),
    ],
)
def test_to_go_on_with_something_else_is_refused_by_the_first_difference(tmp_path, changes, words):
    begin(tmp_path)
    leave_results(tmp_path)
    before = files(tmp_path)
    with pytest.raises(BadInput, match=words):
        begin(tmp_path, dataclasses.replace(EXPERIMENT, **changes), resume=True)
    assert files(tmp_path) == before


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"fingerprint": "0123456789abcdef"},
            r"other code or models \(fingerprint 0123456789abcdef, version 0\.0\.1\)",
        ),
        ({"fingerprint": None}, r"other code or models \(fingerprint not kept yet, version 0\.0\.1\)"),
    ],
)
def test_what_other_code_began_is_not_gone_on_with(tmp_path, changes, words):
    begin(tmp_path)
    leave_results(tmp_path)
    told = {**json.loads((tmp_path / "experiment.json").read_text()), "version": "0.0.1", **changes}
    written = {key: value for key, value in told.items() if value is not None}
    (tmp_path / "experiment.json").write_text(json.dumps(written))
    before = files(tmp_path)
    for resume in (lambda: mut.begun_in(tmp_path), lambda: begin(tmp_path, resume=True)):
        with pytest.raises(BadInput, match=words) as caught:
            resume()
        assert "--overwrite begins anew" in str(caught.value)
        assert "\n" not in str(caught.value)
    assert files(tmp_path) == before
    begin(tmp_path, overwrite=True)  # But it can be replaced.
    assert mut.begun_in(tmp_path) == EXPERIMENT


def test_the_same_code_goes_on_whatever_its_version_is_called(tmp_path):
    begin(tmp_path)
    told = json.loads((tmp_path / "experiment.json").read_text())
    (tmp_path / "experiment.json").write_text(json.dumps({**told, "version": "0+unknown"}))
    begin(tmp_path, resume=True)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}"])
def test_what_is_no_experiment_is_told_in_one_line(tmp_path, text):
    (tmp_path / "experiment.json").write_text(text)
    with pytest.raises(BadInput, match=r"experiment\.json"):
        mut.begun_in(tmp_path)


def test_one_process_at_a_time_writes(tmp_path):
    with (
        mut.experiment_folder(tmp_path, EXPERIMENT),
        pytest.raises(BadInput, match="another process writes there"),
        mut.experiment_folder(tmp_path, EXPERIMENT, resume=True),
    ):
        pass
    begin(tmp_path, resume=True)  # The lock has fallen.


def test_a_folder_that_cannot_be_made_is_told_in_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        begin(tmp_path / "file" / "results")


def test_what_is_begun_in_a_folder_that_it_cannot_be_written_to_is_told_in_one_line(tmp_path):
    (tmp_path / "experiment.json.new").mkdir()
    with pytest.raises(BadInput, match=r"experiment\.json: cannot be written"):
        begin(tmp_path)


def test_what_was_begun_with_another_ward_map_of_ones_own_is_not_gone_on_with(tmp_path):
    ward = tmp_path / "own.ward.yaml"
    ward.write_text("title: first\n")
    experiment = dataclasses.replace(EXPERIMENT, base=Scenario(episodes=3, ward=str(ward)))
    folder = tmp_path / "results"
    begin(folder, experiment)
    begin(folder, experiment, resume=True)

    ward.write_text("title: second\n")
    with pytest.raises(BadInput, match="other code or models"):
        begin(folder, experiment, resume=True)

    ward.unlink()
    with pytest.raises(BadInput, match=r"own\.ward\.yaml: cannot be read"):
        begin(folder, experiment, resume=True)


@pytest.mark.parametrize("changes", [{"profiles": ["../valuable"]}, {"conditions": {"": {}, "..": {}}}])
@pytest.mark.parametrize("options", [{"overwrite": True}, {"resume": True}])
def test_no_file_makes_it_touch_what_is_outside(tmp_path, changes, options):
    folder, valuable = tmp_path / "results", tmp_path / "valuable" / "seed_0" / "kept"
    valuable.mkdir(parents=True)
    begin(folder)
    path = folder / "experiment.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    with pytest.raises(BadInput, match=r"\.\..* as a name"):
        begin(folder, **options)
    assert valuable.exists()
