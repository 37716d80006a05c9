"""From options to an experiment: what nobody asks for is as usual, or as it was begun."""

from __future__ import annotations

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import experiment_kind as mut
from mala_drake.experiments.ablations import ABLATION_KIND
from mala_drake.experiments.convergence import CONVERGENCE
from mala_drake.experiments.targets import TARGETS
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import Scenario


def chosen(kind=CONVERGENCE, begun=None, **options):
    return mut.chosen_experiment(kind, mut.ExperimentOptions(**options), begun=begun)


def test_convergence_is_usually_that_of_the_paper():
    experiment = chosen()
    assert len(experiment.runs) == 25
    assert experiment.base == Scenario(task="alternate", episodes=40)
    assert list(experiment.conditions) == [""]
    assert experiment.scenario(experiment.runs[0]).learner == Scenario().learner


def test_ablations_have_two_patients_or_all_of_them():
    usual, full = chosen(ABLATION_KIND), chosen(ABLATION_KIND, full=True)
    assert (len(usual.profiles), usual.seeds, usual.base.episodes) == (2, (0, 1, 2, 3, 4), 20)
    assert (full.profiles, full.seeds, full.base.episodes) == (tuple(PROFILES), (0, 1, 2, 3, 4), 40)
    assert next(iter(usual.conditions)) == "full"


def test_options_decide():
    experiment = chosen(
        profiles=("safety_first",),
        seeds=(3, 1),
        episodes=7,
        conditions=("fixed", "bandit"),
        task="meal",
        solver="rti",
    )
    assert (experiment.profiles, experiment.seeds) == (("safety_first",), (3, 1))
    assert (experiment.base.episodes, experiment.base.task, experiment.base.control.solver) == (7, "meal", "rti")
    assert {name: experiment.scenario(run).learner.name for run in experiment.runs for name in [run.condition]} == {
        "": "fixed",
        "bandit": "bandit",
    }


def test_a_file_gives_what_no_option_decides(tmp_path):
    (tmp_path / "base.yaml").write_text("{episodes: 3, learner: {name: fixed}, patient: {noise: 0.2}}")
    experiment = chosen(scenario=tmp_path / "base.yaml", task="meal")
    base = experiment.base
    assert (base.episodes, base.task, base.patient.noise) == (3, "meal", 0.2)
    assert experiment.profiles == tuple(PROFILES)
    assert experiment.scenario(experiment.runs[0]).learner.name == "fixed"
    assert chosen(scenario=tmp_path / "base.yaml").base.task == "alternate"  # As usual in experiments.


def test_a_file_with_a_patient_of_its_own_is_about_that_patient(tmp_path):
    (tmp_path / "base.yaml").write_text("patient: {true_weights: [0.3, 0.3, 0.2, 0.1, 0.1]}")
    assert chosen(scenario=tmp_path / "base.yaml").profiles == ("custom",)
    assert chosen(scenario=tmp_path / "base.yaml", profiles=("custom", "safety_first")).profiles[1] == "safety_first"


@pytest.mark.parametrize(
    "options",
    [
        {"profiles": ("safety_first",), "seeds": (3,), "episodes": 7, "conditions": ("fixed",), "solver": "rti"},
        {"task": "meal"},
        {},
    ],
)
def test_to_go_on_needs_no_options(options):
    begun = chosen(**options)
    assert chosen(begun=begun) == begun
    assert chosen(begun=begun, **options) == begun


def test_an_option_that_differs_from_what_was_begun_stays_different():
    begun = chosen(episodes=7)
    assert chosen(begun=begun, episodes=8).base.episodes == 8
    assert chosen(begun=begun, conditions=("bandit",)).conditions != begun.conditions


def test_the_file_of_the_beginning_may_be_given_again(tmp_path):
    (tmp_path / "base.yaml").write_text("{episodes: 3, patient: {noise: 0.2}}")
    begun = chosen(scenario=tmp_path / "base.yaml", episodes=5)
    assert chosen(begun=begun, scenario=tmp_path / "base.yaml", episodes=5) == begun
    assert chosen(begun=begun, scenario=tmp_path / "base.yaml") == begun
    (tmp_path / "other.yaml").write_text("{episodes: 3}")
    assert chosen(begun=begun, scenario=tmp_path / "other.yaml") != begun


@pytest.mark.parametrize(
    ("kind", "options", "words"),
    [
        (CONVERGENCE, {"profiles": ("nobody",)}, "--profiles: 'nobody'"),
        (CONVERGENCE, {"profiles": ("custom",)}, "--profiles: 'custom'"),
        (CONVERGENCE, {"conditions": ("oracle",)}, "--learners: 'oracle'"),
        (ABLATION_KIND, {"conditions": ("posterior",)}, "--conditions: 'posterior'"),
        (CONVERGENCE, {"seeds": (1, 1)}, "--seeds: the same twice"),
        (CONVERGENCE, {"seeds": (-1,)}, "--seeds: -1"),
        (CONVERGENCE, {"full": True}, "--full"),
    ],
)
def test_what_does_not_fit_is_told_in_one_line(kind, options, words):
    with pytest.raises(BadInput, match=words):
        chosen(kind, **options)


def test_learners_are_compared_each_with_what_the_file_sets_of_it(tmp_path):
    (tmp_path / "base.yaml").write_text("learner: {name: projected_gradient, learning_rate: 0.05}")
    experiment = chosen(scenario=tmp_path / "base.yaml", conditions=("projected_gradient", "posterior"))
    rates = {run.condition: experiment.scenario(run).learner.learning_rate for run in experiment.runs}
    assert rates == {"": 0.05, "posterior": Scenario().learner.learning_rate}


def test_another_solver_drives_without_what_the_file_sets_of_its_own(tmp_path):
    (tmp_path / "base.yaml").write_text("control: {sqp_iterations: 1, tolerance: 0.001}")
    experiment = chosen(scenario=tmp_path / "base.yaml", solver="snopt")
    control = experiment.scenario(experiment.runs[0]).control
    assert (control.solver, control.sqp_iterations, control.tolerance) == ("snopt", 20, 0.001)


def test_a_learner_that_does_not_fit_the_file_is_refused(tmp_path):
    (tmp_path / "base.yaml").write_text("learner: {name: fixed, initial_weights: [1, 0, 0, 0, 0]}")
    with pytest.raises(BadInput, match=r"learner\.initial_weights: given to posterior"):
        chosen(scenario=tmp_path / "base.yaml", conditions=("fixed", "posterior"))


@pytest.mark.parametrize("kind", [CONVERGENCE, ABLATION_KIND, TARGETS], ids=lambda kind: kind.name)
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"episodes": 0}, "^--episodes: 0"),
        ({"task": "dance"}, "^--task: 'dance'"),
        ({"solver": "guess"}, "^--solver: 'guess'"),
    ],
)
def test_an_option_that_no_scenario_can_have_is_told_by_its_name(kind, options, words):
    with pytest.raises(BadInput, match=words):
        chosen(kind, **options)
