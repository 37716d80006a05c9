"""Settings that change nothing, since what they belong to is not chosen.

In a file they are a mistake of who wrote it, and refused. Where an option or a condition of an experiment replaces a
choice, what belonged to the choice before goes with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.scenario.fields import Scenario

_GRADIENT_LEARNERS = ("projected_gradient", "reference_gradient")


@dataclass(frozen=True, slots=True)
class _Setting:
    """A field of a section of the scenario, when it is used, and what has to be chosen for that."""

    section: str
    name: str
    used: Callable[[Scenario], bool]
    choice: str

    def default(self, scenario: Scenario) -> Any:
        """What the field is when nobody sets it."""
        return getattr(type(getattr(scenario, self.section))(), self.name)

    def value(self, scenario: Scenario) -> Any:
        """What it is."""
        return getattr(getattr(scenario, self.section), self.name)


def _with_gradient(scenario: Scenario) -> bool:
    return scenario.learner.name in _GRADIENT_LEARNERS


def _with_rti(scenario: Scenario) -> bool:
    return scenario.control.solver == "rti"


def _with_targets(scenario: Scenario) -> bool:
    return scenario.control.learned_targets


_GRADIENT, _RTI = "learner.name: " + " or ".join(_GRADIENT_LEARNERS), "control.solver: rti"
_TARGETS = "control.learned_targets: true"

_SETTINGS = (
    _Setting(
        "patient",
        "earlier_weights",
        lambda s: s.patient.earlier_episodes > 0,
        "patient.earlier_episodes: the number of episodes that they are for",
    ),
    _Setting("learner", "learning_rate", _with_gradient, _GRADIENT),
    _Setting("learner", "exploration", _with_gradient, _GRADIENT),
    _Setting("learner", "exploration_decay", _with_gradient, _GRADIENT),
    _Setting("learner", "exploration_until", lambda s: s.learner.name == "posterior", "learner.name: posterior"),
    _Setting("control", "sqp_iterations", _with_rti, _RTI),
    _Setting("control", "qp_solver", _with_rti, _RTI),
    _Setting("control", "target_evidence", _with_targets, _TARGETS),
    _Setting("control", "target_sensitivity", _with_targets, _TARGETS),
    _Setting(
        "control", "translation_rate", lambda s: s.control.learned_translation, "control.learned_translation: true"
    ),
)


def refuse_unused(scenario: Scenario, at: str) -> None:
    """Refuses a setting that is not the default one and changes nothing; `at` begins what the error says.

    Raises:
        BadInput: for the first one.
    """
    for setting in _unused(scenario):
        what = f"{setting.value(scenario)}, which changes nothing here"
        raise BadInput(f"{at}{setting.section}.{setting.name}", what, f"nothing, or {setting.choice}")


def reset_unused(scenario: Scenario) -> None:
    """Gives settings that change nothing their defaults, in place."""
    for setting in _unused(scenario):
        setattr(getattr(scenario, setting.section), setting.name, setting.default(scenario))


def _unused(scenario: Scenario) -> Iterator[_Setting]:
    """The settings that are not the default ones and change nothing."""
    for setting in _SETTINGS:
        if not setting.used(scenario) and setting.value(scenario) != setting.default(scenario):
            yield setting
