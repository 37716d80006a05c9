"""The kinds of experiments, and how the options of one become what is run."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mala_drake.errors import BadInput
from mala_drake.experiments.experiment import CUSTOM, Changes, Experiment, known_profiles
from mala_drake.scenario import LoadScenario, Scenario, Validate, reset_unused


@dataclass(frozen=True, slots=True)
class Size:
    """How many runs there are of each condition, and how long they are."""

    profiles: tuple[str, ...]
    seeds: tuple[int, ...]
    episodes: int


@dataclass(frozen=True, slots=True)
class ExperimentKind:
    """An experiment before its options are chosen.

    Attributes:
        name: on the command line.
        size: when nothing else is asked for.
        condition_option: the option that chooses conditions by name.
        condition_names: what it may name.
        conditions: makes the conditions from the base scenario and the names; None stands for the usual ones.
        full_size: when everything is asked for; None when that is the size anyway.
        explanations: what each condition means, where a page is to tell it.
    """

    name: str
    size: Size
    condition_option: str
    condition_names: tuple[str, ...]
    conditions: Callable[[Scenario, Sequence[str] | None], Mapping[str, Changes]]
    full_size: Size | None = None
    explanations: Mapping[str, str] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExperimentOptions:
    """What somebody asks for; None where nothing is asked for.

    Attributes:
        scenario: file of the base scenario.
        profiles: of patients.
        seeds: of runs.
        episodes: of each run.
        conditions: by name, or learners.
        task: of the episodes.
        solver: of the MPC.
        full: whether the full size is wanted.
    """

    scenario: Path | None = None
    profiles: tuple[str, ...] | None = None
    seeds: tuple[int, ...] | None = None
    episodes: int | None = None
    conditions: tuple[str, ...] | None = None
    task: str | None = None
    solver: str | None = None
    full: bool = False


def chosen_experiment(kind: ExperimentKind, options: ExperimentOptions, *, begun: Experiment | None) -> Experiment:
    """The experiment that is asked for, validated.

    Args:
        kind: of the experiment.
        options: what is asked for.
        begun: what is to be gone on with, if anything: it stands in for what nobody asks for.

    Raises:
        BadInput: if an option does not fit.
    """
    _check(kind, options)
    size = kind.full_size if options.full and kind.full_size else kind.size
    base = _base(options, size, begun)
    _check_base(base)
    usual_profiles = (CUSTOM,) if base.patient.true_weights else size.profiles
    if options.conditions is None and begun is not None:
        conditions = begun.conditions
    else:
        conditions = kind.conditions(base, options.conditions)
    experiment = Experiment(
        name=kind.name,
        base=base,
        conditions=conditions,
        profiles=options.profiles or (begun.profiles if begun else usual_profiles),
        seeds=options.seeds or (begun.seeds if begun else size.seeds),
    )
    experiment.validate()
    return experiment


_OPTION_OF = {"task": "--task", "episodes": "--episodes", "control.solver": "--solver"}


def _check(kind: ExperimentKind, options: ExperimentOptions) -> None:
    if options.full and kind.full_size is None:
        raise BadInput("--full", f"{kind.name} has no larger size", "to leave it out")
    named = (
        ("--profiles", options.profiles, known_profiles()),
        (kind.condition_option, options.conditions, kind.condition_names),
    )
    for option, names, known in named:
        for name in names or ():
            if name not in known:
                raise BadInput(option, repr(name), "one of " + ", ".join(known))
    for option, several in (*((option, names) for option, names, _ in named), ("--seeds", options.seeds)):
        if several is not None and len(set(several)) < len(several):
            raise BadInput(option, "the same twice", "each once")
    for seed in options.seeds or ():
        if seed < 0:
            raise BadInput("--seeds", str(seed), "whole numbers >= 0")


def _check_base(base: Scenario) -> None:
    """What options have made of the base scenario, a mistake told by the option's name; conditions come later."""
    checked = copy.deepcopy(base)
    reset_unused(checked)  # What the file sets of the solver that an option has replaced.
    try:
        Validate(checked, where="")
    except BadInput as error:
        raise BadInput(_OPTION_OF.get(error.where, error.where), error.what, error.expected) from None


def _base(options: ExperimentOptions, size: Size, begun: Experiment | None) -> Scenario:
    """The base scenario: what is asked for, else what was begun, else what the file says, else what is usual."""
    usual = Scenario(task="alternate", episodes=size.episodes)
    if options.scenario is not None:
        base = LoadScenario(options.scenario, defaults=usual)
    else:
        base = copy.deepcopy(begun.base) if begun else usual
    before = begun.base if begun else base
    base.task = before.task if options.task is None else options.task
    base.episodes = before.episodes if options.episodes is None else options.episodes
    base.control.solver = before.control.solver if options.solver is None else options.solver
    return base
