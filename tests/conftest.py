"""Fixtures shared by the whole suite (test modules import helpers that stand beside them, never each other)."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml
from hypothesis import settings
from pydrake.systems.framework import System

from mala_drake.scenario import LoadScenario, Scenario
from mala_drake.ward.ward_map import LoadWard, Ward

# A shared machine makes any deadline a coin toss, and a suite that others run must not find new examples each time.
settings.register_profile("suite", deadline=None, derandomize=True, database=None)
settings.load_profile("suite")


def _drawn_box(system_class: type) -> dict[str, list[str] | str]:
    """The port box drawn in a system's docstring (`.. pydrake_system::`), as a dictionary."""
    # Python 3.13 strips the docstring's indentation itself; cleandoc makes all versions alike.
    text = inspect.cleandoc(system_class.__doc__ or "") + "\n"
    block = re.search(r"\.\. pydrake_system::\n\n((?: {4}.*\n|\n)+)", text)
    assert block is not None, f"{system_class.__name__} draws no port box"
    drawn = yaml.safe_load(block.group(1))
    assert isinstance(drawn, dict), f"{system_class.__name__}: the port box is not a YAML mapping"
    return drawn


@pytest.fixture
def assert_port_box() -> Callable[[System], None]:
    """A callable that compares the port box in a system's class docstring with the system's real ports, in order."""

    def check(system: System) -> None:
        drawn = _drawn_box(type(system))
        assert drawn["name"] == type(system).__name__
        assert (drawn.get("input_ports") or []) == [
            system.get_input_port(i).get_name() for i in range(system.num_input_ports())
        ]
        assert (drawn.get("output_ports") or []) == [
            system.get_output_port(i).get_name() for i in range(system.num_output_ports())
        ]

    return check


@pytest.fixture(scope="session")
def ward() -> Ward:
    """The ward that comes with the package."""
    return LoadWard()


@pytest.fixture
def load_scenario(tmp_path: Path) -> Callable[[str], Scenario]:
    """A callable that reads the scenario with this text; it comes from a file `mine.scenario.yaml` in `tmp_path`."""

    def load(text: str) -> Scenario:
        path = tmp_path / "mine.scenario.yaml"
        path.write_text(text, encoding="utf-8")
        return LoadScenario(path)

    return load
