"""Scenario files: what is missing has its default, and paths are the file's own."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import mala_drake
from mala_drake.patient.profiles import PROFILES
from mala_drake.resources import models_folder
from mala_drake.scenario import Scenario
from mala_drake.scenario import file as mut


def test_the_default_scenario_is_a_round_of_medicine_and_a_meal():
    scenario = mut.LoadScenario()
    assert (scenario.task, scenario.episodes, scenario.random_seed) == ("alternate", 2, 0)
    assert scenario.true_weights == PROFILES["speed_oriented"]


def test_the_default_scenario_says_where_its_fields_are_explained():
    file = models_folder() / "default.scenario.yaml"
    (named,) = re.findall(r"mala_drake/(\S+\.py)", file.read_text(encoding="utf-8"))
    assert Path(mala_drake.__file__).parent / named == Path(inspect.getfile(Scenario))


def test_an_empty_file_is_the_default_scenario(load_scenario):
    assert load_scenario("") == Scenario()


def test_numbers_may_have_exponents(load_scenario):
    assert load_scenario("control: {tolerance: 1e-3}").control.tolerance == 1e-3


def test_a_ward_is_found_from_the_scenario_s_own_folder(tmp_path, load_scenario):
    plain_map = (models_folder() / "care_center.ward.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.ward.yaml").write_text(plain_map, encoding="utf-8")
    assert load_scenario("ward: mine.ward.yaml").load_ward() == Scenario().load_ward()


def test_the_path_of_a_ward_is_whole_for_whoever_reads_it_from_another_folder(tmp_path, monkeypatch):
    plain_map = (models_folder() / "care_center.ward.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.ward.yaml").write_text(plain_map, encoding="utf-8")
    (tmp_path / "mine.scenario.yaml").write_text("ward: mine.ward.yaml")
    monkeypatch.chdir(tmp_path)
    assert mut.LoadScenario("mine.scenario.yaml").ward == str(tmp_path / "mine.ward.yaml")
