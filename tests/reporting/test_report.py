"""The whole report: every file is there, the same each time, from one episode to an experiment with failures."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import asdict, replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import mala_drake
from mala_drake.errors import BadInput
from mala_drake.reporting import report as mut
from mala_drake.reporting.table import Group, Table
from mala_drake.scenario import Scenario

LOADS = {"src", "href", "xlink:href", "srcset", "data", "action", "poster"}
EMPTY = {"meta", "link", "br", "img", "hr", "input"}


class Page(HTMLParser):
    """Collects what a page loads and its text, and fails on tags that do not pair up."""

    def __init__(self, text):
        super().__init__()
        self.open, self.loads, self.ids, self.text = [], [], [], ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        if tag not in EMPTY:
            self.open.append(tag)
        self.loads += [value for name, value in attributes if name in LOADS]
        self.ids += [value for name, value in attributes if name == "id"]

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in EMPTY:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def read(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def experiment(tmp_path_factory, simulate_results):
    folder = tmp_path_factory.mktemp("experiment")
    simulate_results(folder, profiles=("speed_oriented", "safety_first"), episodes=4, tasks=("medication", "meal"))
    simulate_results(folder, profiles=("speed_oriented",), episodes=2, condition="projected_gradient", step_size=0.03)
    return folder


@pytest.fixture(scope="module")
def written(experiment):
    return mut.write_report(experiment)


def test_every_picture_shows_something(written):
    pictures = [path for path in written if path.suffix == ".png"]
    names = {path.stem for path in pictures}
    assert {"distance", "weights", "final_weights", "plans", "meals", "features", "prediction", "conditions"} <= names
    assert "floor_plan_medication" in names
    for path in pictures:
        pixels = imread(path)[:, :, :3]
        assert min(pixels.shape[:2]) > 100
        assert 0.01 < np.mean(np.abs(pixels - pixels[0, 0]).max(axis=2) > 0.05) < 0.95, path.name
        assert path.with_suffix(".pdf").read_bytes().startswith(b"%PDF")


def test_tables_are_written_for_readme_and_paper(written):
    assert {path.name for path in written if path.suffix in (".md", ".tex")} == {
        f"{name}.{suffix}" for name in ("convergence", "conditions", "execution", "timing") for suffix in ("md", "tex")
    }


def test_the_page_stands_alone(written):
    text = written[0].read_text(encoding="utf-8")
    page = Page(text)
    assert all(load.startswith("#") for load in page.loads)
    assert "http:" not in text
    assert "https:" not in text
    assert "@import" not in text
    assert "url(" not in re.sub(r"url\(#", "", text)
    assert len(page.ids) == len(set(page.ids))
    assert {load[1:] for load in page.loads} <= set(page.ids)
    assert text.count("<svg") == sum(path.suffix == ".png" for path in written)


def test_the_same_results_give_the_same_bytes_in_any_process(experiment, written, tmp_path):
    command = [sys.executable, "-m", "mala_drake", "report", str(experiment), "--out", str(tmp_path / "again")]
    root = str(Path(mala_drake.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root, "PYTHONHASHSEED": "7"}
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=environment, cwd=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "report.html" in ended.stdout
    assert read(tmp_path / "again") == read(written[0].parent)


def test_problems_stand_above_all_figures(written):
    text = Page(written[0].read_text(encoding="utf-8")).text
    assert text.index("There is no summary.json") < text.index("Figure 1")
    assert "No episode failed" not in text


def test_one_failed_episode_in_a_ward_that_is_gone_is_enough(tmp_path, simulate_results):
    """Unrated, and with nothing measured; what the failure says is text and no markup."""

    def fail(record):
        nothing = dict.fromkeys(record.features, float("nan"))
        return replace(
            record,
            success=False,
            failure="the way is <blocked>",
            actions=[],
            features=nothing,
            predicted_features=nothing,
            ratings=[None] * 5,
            plan_cost=float("inf"),
            timing={},
        )

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1, change=fail)
    ward = tmp_path / "gone.ward.yaml"
    (tmp_path / "summary.json").write_text(json.dumps({"scenario": {"ward": str(ward)}}))
    text = Page(mut.write_report(tmp_path)[0].read_text(encoding="utf-8")).text
    assert "1 of 1 episode failed (1 × the way is <blocked>)" in text
    assert f"The ward map {ward} cannot be used (cannot be read" in text
    assert "the map that comes with the package" in text


def test_a_plain_run_of_an_unknown_patient_is_shown_with_intervals_and_without_truth(tmp_path, simulate_results):
    def sure(record):
        return replace(record, weights_std=[0.1 / (1 + record.episode)] * 5)

    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), change=sure)
    path = tmp_path / "speed_oriented" / "seed_0" / "episodes.jsonl"
    path.write_text(path.read_text().replace('"profile": "speed_oriented"', '"profile": "custom"'))
    text = Page(mut.write_report(path.parent)[0].read_text(encoding="utf-8")).text
    assert "90 % credible interval" in text
    assert "runs know what matters most" not in text


def test_displaced_targets_have_a_section_of_their_own(tmp_path, simulate_targets):
    learned = [
        [("pantry", (0.0, -1.2), 0.3, True), ("pantry", (0.1, 0.0), 0.0, True)],
        [("patient_bed_left", (0.4, 0.0), 0.2, True), ("patient_bed_left", (0.4, 0.0), 0.0, False)],
    ]
    mapped = [[("pantry", (0.5, -1.9), 0.3, False)]]
    simulate_targets(tmp_path, {"full": learned, "outer_loop_only": mapped})
    written = mut.write_report(tmp_path)
    names = {path.name for path in written}
    assert {"target_distance.png", "target_map.png", "target_paths.png"} <= names
    assert {"targets.md", "targets.tex", "target_conditions.md", "target_conditions.tex"} <= names
    text = Page(written[0].read_text(encoding="utf-8")).text
    assert "places that are not where the map says" in text
    assert "4/4displaced places found" in text
    assert "Under outer loop only no target ever moves." in text


def test_what_single_actions_and_the_controller_came_to_has_a_section_of_its_own(
    tmp_path, simulate_results, with_learned_control
):
    folder = simulate_results(tmp_path, profiles=("speed_oriented",), episodes=3, change=with_learned_control)
    (folder / "summary.json").write_text(json.dumps({"scenario": asdict(Scenario())}))
    written = mut.write_report(folder)
    names = {path.name for path in written}
    pictures = ("mismatches", "dynamics", "model_errors", "weight_factors", "translation")
    assert {f"{name}.{suffix}" for name in pictures for suffix in ("png", "pdf")} <= names
    assert {"actions.md", "actions.tex", "dynamics.md", "dynamics.tex"} <= names
    for path in written:
        if path.stem in pictures and path.suffix == ".png":
            pixels = imread(path)[:, :, :3]
            assert 0.01 < np.mean(np.abs(pixels - pixels[0, 0]).max(axis=2) > 0.05) < 0.95, path.name
    page = written[0].read_text(encoding="utf-8")
    assert 'href="#inner_loop"' in page
    text = Page(page).text
    assert "not the patient's own rating" in text
    assert "The controller's model, as it was learned" in text
    for promise in ("becomes the robot's", "come closer"):  # No figure says so before the data do.
        assert promise not in text


def test_results_of_earlier_versions_have_no_such_section(written):
    assert "inner_loop" not in written[0].read_text(encoding="utf-8")


def test_no_results_are_one_line(tmp_path):
    with pytest.raises(BadInput, match="has no episodes"):
        mut.write_report(tmp_path)


def test_a_report_that_cannot_be_written_is_refused_before_any_work(tmp_path, simulate_results):
    simulate_results(tmp_path / "results", profiles=("speed_oriented",))
    (tmp_path / "file").touch()
    with pytest.raises(BadInput, match="folder cannot be made"):
        mut.write_report(tmp_path / "results", tmp_path / "file")


@pytest.mark.parametrize("name", ["figures", "tables", "report.html"])
def test_what_is_in_the_way_of_a_report_is_told_in_one_line(tmp_path, simulate_results, name):
    """A file where a folder is to be, or a folder where a file is to be."""
    folder = simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    path = folder / "report" / name
    path.parent.mkdir(parents=True)
    path.mkdir() if path.suffix else path.touch()
    with pytest.raises(BadInput, match=path.stem) as refused:
        mut.write_report(folder)
    assert "\n" not in str(refused.value)


def test_what_is_in_the_way_of_a_table_is_told_in_one_line(tmp_path):
    table = Table("execution", "Nothing.", ("name",), (Group((("x",),)),))
    (tmp_path / "tables" / "execution.md").mkdir(parents=True)
    with pytest.raises(BadInput, match=r"execution\.md: cannot be written"):
        list(mut._write(table, tmp_path))
