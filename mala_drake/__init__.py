"""A care robot that schedules, plans, drives and learns: one Drake systems diagram from PDDL to physics."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mala_drake.scenario import LoadScenario
    from mala_drake.station import MakeCareStation

__all__ = ["LoadScenario", "MakeCareStation", "__version__"]

try:
    __version__ = version("mala_drake")
except PackageNotFoundError:  # Run from a checkout that is not installed.
    __version__ = "0+unknown"


def __getattr__(name: str) -> Any:
    """Imports Drake only when the diagram is wanted: pure parts and `--help` stay quick."""
    if name == "LoadScenario":
        from mala_drake.scenario import LoadScenario

        return LoadScenario
    if name == "MakeCareStation":
        from mala_drake.station import MakeCareStation

        return MakeCareStation
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
