"""Models and domains are found in a checkout and in an installed wheel."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest

from mala_drake import resources as mut


def test_the_models_folder_is_the_package_that_uris_name():
    manifest = ElementTree.parse(mut.models_folder() / "package.xml")
    assert manifest.findtext("name") == "mala_drake"
    assert (mut.models_folder() / "care_robot.sdf").is_file()


def test_the_domains_folder_has_the_medication_task():
    assert (mut.domains_folder() / "domain_med.pddl").is_file()
    assert (mut.domains_folder() / "problem_med.pddl").is_file()


@pytest.mark.parametrize(("name", "find"), [("models", mut.models_folder), ("domains", mut.domains_folder)])
@pytest.mark.parametrize("installed", [False, True])
def test_a_wheel_has_them_inside_the_package_and_a_checkout_beside_it(tmp_path, monkeypatch, name, find, installed):
    package = tmp_path / "mala_drake"
    inside, beside = package / name, tmp_path / name
    (inside if installed else beside).mkdir(parents=True)
    monkeypatch.setattr(mut, "_PACKAGE", package)
    assert find() == (inside if installed else beside)
