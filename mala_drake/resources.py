"""Where the models and domains are: beside the package in a checkout, inside it in an installed wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _folder(name: str) -> Path:
    installed = _PACKAGE / name
    return installed if installed.is_dir() else _PACKAGE.parent / name


def models_folder() -> Path:
    """The folder that `package://mala_drake/` refers to: SDF models, the ward and the scenarios."""
    return _folder("models")


def domains_folder() -> Path:
    """The folder of the PDDL files."""
    return _folder("domains")
