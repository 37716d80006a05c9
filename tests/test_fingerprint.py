"""The fingerprint of code and data: the same wherever they are, another for whatever decides results."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import mala_drake
from mala_drake import fingerprint as mut
from mala_drake.errors import BadInput
from mala_drake.resources import domains_folder, models_folder

FILES = {
    "mala_drake/__init__.py": b"",
    "mala_drake/control/model.py": b"MASS = 60.0\nWIDTH = 0.4\n",
    "models/robot.sdf": b"<sdf>\n</sdf>\n",
    "models/ward/bed.obj": b"v 0 0 1\n",
    "domains/meal.pddl": b"(define (domain meal))\n",
}


def write(root, files, *, wheel=False):
    """The fingerprint of these files, as in a checkout or as in a wheel."""
    package = root / "mala_drake"
    beside = package if wheel else root
    for name, content in files.items():
        path = root / name if name.startswith("mala_drake/") else beside / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return mut.fingerprint_of(package, beside / "models", beside / "domains")


@pytest.fixture
def usual(tmp_path):
    return write(tmp_path / "usual", FILES)


def test_it_is_the_same_in_a_checkout_and_in_a_wheel_wherever_they_are(tmp_path, usual):
    assert write(tmp_path / "a" / "b", FILES) == usual
    assert write(tmp_path / "site-packages", FILES, wheel=True) == usual
    assert len(usual) == 16


def test_the_order_of_files_and_the_ends_of_lines_do_not_count(tmp_path, usual):
    reordered = {name: content.replace(b"\n", b"\r\n") for name, content in reversed(FILES.items())}
    assert write(tmp_path / "windows", reordered) == usual


@pytest.mark.parametrize(
    "others",
    [
        {"mala_drake/__pycache__/model.cpython-311.pyc": b"1"},
        {"mala_drake/reporting/page.html": b"<p>"},
        {"models/.robot.sdf.swp": b"1"},
    ],
)
def test_what_decides_nothing_does_not_count(tmp_path, usual, others):
    assert write(tmp_path / "other", FILES | others) == usual


@pytest.mark.parametrize("name", sorted(FILES))
def test_every_file_counts_with_its_name(tmp_path, usual, name):
    assert write(tmp_path / "changed", FILES | {name: FILES[name] + b"#"}) != usual
    without = {other: content for other, content in FILES.items() if other != name}
    assert write(tmp_path / "without", without) != usual
    assert write(tmp_path / "renamed", without | {f"{name[:-4]}x{name[-4:]}": FILES[name]}) != usual


def test_a_ward_map_of_ones_own_counts_by_its_content(tmp_path):
    ward, moved = tmp_path / "own.ward.yaml", tmp_path / "moved.ward.yaml"
    ward.write_bytes(b"title: first\n")
    moved.write_bytes(b"title: first\r\n")
    first = mut.fingerprint(str(ward))
    assert first == mut.fingerprint(str(moved)) != mut.fingerprint()
    assert len(first) == 16

    ward.write_bytes(b"title: second\n")
    assert mut.fingerprint(str(ward)) not in (first, mut.fingerprint())
    with pytest.raises(BadInput, match=r"absent\.yaml: cannot be read"):
        mut.fingerprint(str(tmp_path / "absent.yaml"))


def test_that_of_the_package_is_that_of_a_copy(tmp_path):
    package = Path(mala_drake.__file__).parent
    shutil.copytree(package, tmp_path / "copy", ignore=shutil.ignore_patterns("models", "domains"))
    assert mut.fingerprint_of(tmp_path / "copy", models_folder(), domains_folder()) == mut.fingerprint()
