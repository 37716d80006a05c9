"""The paper's main experiment: how fast, and how closely, each patient's preferences are learned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mala_drake.experiments.experiment import MAIN, Changes
from mala_drake.experiments.experiment_kind import ExperimentKind, Size
from mala_drake.learning.make_learner import LEARNER_NAMES
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import Scenario

CONVERGENCE = ExperimentKind(
    name="convergence",
    size=Size(profiles=tuple(PROFILES), seeds=tuple(range(5)), episodes=40),
    condition_option="--learners",
    condition_names=LEARNER_NAMES,
    conditions=lambda base, learners: learner_conditions(base, learners),
)
"""Five profiles, five seeds, forty episodes, medication and meals in turn (paper, Sec. "Simulation Results")."""


def learner_conditions(base: Scenario, learners: Sequence[str] | None) -> Mapping[str, Changes]:
    """One condition a learner; the first is the main one. None stands for the scenario's own learner alone."""
    first, *others = learners or (base.learner.name,)
    return {MAIN: _with_learner(first)} | {name: _with_learner(name) for name in others}


def _with_learner(name: str) -> Changes:
    return {"learner": {"name": name}}
