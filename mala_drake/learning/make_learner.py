"""The preference learners by name, made from the settings of a scenario."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Protocol

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner
from mala_drake.learning.bandit import Bandit
from mala_drake.learning.fixed_weights import FixedWeights
from mala_drake.learning.posterior import Posterior
from mala_drake.learning.projected_gradient import ProjectedGradient
from mala_drake.learning.random_weights import RandomWeights
from mala_drake.preferences import UNIFORM_WEIGHTS


class LearnerSettings(Protocol):
    """What a scenario says about the learner; each learner reads the settings that concern it."""

    name: str
    initial_weights: list[float]  # Empty for uniform ones.
    learning_rate: float
    exploration: float
    exploration_decay: float
    exploration_until: float


def make_learner(settings: LearnerSettings, *, where: str = "learner") -> AbstractPreferenceLearner:
    """The learner called `settings.name`; `where` names the settings in an error.

    Raises:
        BadInput: if there is no such learner, or a setting does not fit it.
    """
    if settings.name not in _LEARNERS:
        raise BadInput(f"{where}.name", repr(settings.name), "one of " + ", ".join(LEARNER_NAMES))
    if settings.initial_weights and settings.name not in _STARTING_SOMEWHERE:
        learners = " or ".join(_STARTING_SOMEWHERE)
        raise BadInput(f"{where}.initial_weights", f"given to {settings.name}", f"none, or the learner {learners}")
    return _LEARNERS[settings.name](settings)


_STARTING_SOMEWHERE = ("projected_gradient", "reference_gradient", "fixed")


def _weights(settings: LearnerSettings) -> tuple[float, ...]:
    return tuple(settings.initial_weights) or UNIFORM_WEIGHTS


def _projected_gradient(settings: LearnerSettings) -> ProjectedGradient:
    return ProjectedGradient(
        initial_weights=_weights(settings),
        step_size=settings.learning_rate,
        exploration=settings.exploration,
        exploration_decay=settings.exploration_decay,
    )


def _reference_gradient(settings: LearnerSettings) -> ProjectedGradient:
    return ProjectedGradient.reference_variant(
        initial_weights=_weights(settings),
        step_size=settings.learning_rate,
        exploration=settings.exploration,
        exploration_decay=settings.exploration_decay,
    )


_LEARNERS: Mapping[str, Callable[[LearnerSettings], AbstractPreferenceLearner]] = MappingProxyType(
    {
        "posterior": lambda settings: Posterior(exploration_until=settings.exploration_until),
        "projected_gradient": _projected_gradient,
        "reference_gradient": _reference_gradient,
        "fixed": lambda settings: FixedWeights(weights=_weights(settings)),
        "random": lambda _: RandomWeights(),
        "bandit": lambda _: Bandit(),
    }
)

LEARNER_NAMES = tuple(_LEARNERS)
"""What a scenario may call its learner; the first is the default."""
