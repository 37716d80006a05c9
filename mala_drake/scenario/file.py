"""Scenarios as YAML files: read with defaults, and validated before anything runs."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from mala_drake.configuration import load_typed
from mala_drake.resources import models_folder
from mala_drake.scenario.fields import Scenario
from mala_drake.scenario.validation import Validate


def LoadScenario(path: str | Path | None = None, *, defaults: Scenario | None = None) -> Scenario:
    """Reads and validates a scenario; fields that are missing have their defaults.

    Args:
        path: a Drake YAML file; None is the default scenario that comes with the package.
        defaults: of the fields that are missing, if they are to be others than those of `Scenario`.

    Raises:
        BadInput: naming file, field, value and what was expected.
    """
    file = Path(path) if path is not None else models_folder() / "default.scenario.yaml"
    scenario = load_typed(Scenario, file, defaults=Scenario() if defaults is None else defaults)
    if scenario.ward:
        # Whole, for whoever reads the results from another folder. What can be no path stays for `Validate` to refuse.
        with suppress(ValueError):
            scenario.ward = str((file.parent / scenario.ward).resolve())
    Validate(scenario, where=file.name)
    return scenario
