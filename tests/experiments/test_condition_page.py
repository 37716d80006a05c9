"""The page of an experiment's conditions: the table, and what each of them means."""

from __future__ import annotations

import shutil

from mala_drake.experiments import condition_page as mut
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.scenario import Scenario

MEANINGS = {"full": "the scenario as it is", "no_learning": "nothing is learned", "never_run": "is not there"}


def experiment(*conditions):
    return Experiment("ablations", Scenario(), {condition: {} for condition in conditions}, ("speed_oriented",), (0,))


def write(folder, record, conditions):
    for condition in conditions:
        run = RunName(condition, "speed_oriented", 0)
        (folder / run.folder).mkdir(parents=True)
        (folder / run.folder / "episodes.jsonl").write_text(record.to_json() + "\n")
    (folder / "summary.json").write_text("{}")


def test_it_has_a_row_and_a_meaning_for_each_condition_that_was_run(tmp_path, episode_record):
    write(tmp_path, episode_record(distance_to_true=0.123), ["no_learning", "full"])
    mut.write_condition_page(tmp_path, experiment("full", "no_learning", "never_run"), MEANINGS)
    page = mut.page_of(tmp_path, "ablations").read_text(encoding="utf-8")
    assert page.startswith("# Ablations\n")
    assert [line.split("|")[1].strip() for line in page.splitlines() if "0.123" in line] == ["full", "no learning"]
    assert "- **full**: the scenario as it is.\n- **no learning**: nothing is learned.\n" in page
    assert "is not there" not in page


def test_of_one_condition_there_is_no_table(tmp_path, episode_record):
    write(tmp_path, episode_record(), ["full"])
    mut.write_condition_page(tmp_path, experiment("full"), MEANINGS)
    page = mut.page_of(tmp_path, "ablations").read_text(encoding="utf-8")
    assert "|" not in page
    assert "- **full**: the scenario as it is." in page


def test_folders_that_somebody_has_put_beside_the_runs_are_passed_over(tmp_path, episode_record):
    write(tmp_path, episode_record(), ["full", "no_learning"])
    shutil.copytree(tmp_path / "full", tmp_path / "full_backup")
    shutil.copytree(tmp_path / "full" / "speed_oriented", tmp_path / "full" / "speed_oriented_backup")
    mut.write_condition_page(tmp_path, experiment("full", "no_learning"), MEANINGS)
    page = mut.page_of(tmp_path, "ablations").read_text(encoding="utf-8")
    assert "- **full**" in page
    assert "backup" not in page
