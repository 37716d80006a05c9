"""Settings that change nothing: refused in a file, dropped where another choice is made."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mala_drake.errors import BadInput
from mala_drake.scenario import Scenario, Validate
from mala_drake.scenario import unused as mut

GRADIENT = "learner.name: projected_gradient or reference_gradient"


@pytest.mark.parametrize(
    ("text", "what", "choice"),
    [
        (
            "patient: {earlier_weights: [0.2, 0.2, 0.2, 0.2, 0.2]}",
            "patient.earlier_weights: [0.2, 0.2, 0.2, 0.2, 0.2]",
            "patient.earlier_episodes",
        ),
        ("learner: {learning_rate: 0.05}", "learner.learning_rate: 0.05", GRADIENT),
        ("learner: {exploration: 0.0}", "learner.exploration: 0.0", GRADIENT),
        ("learner: {name: bandit, exploration_decay: 0.5}", "learner.exploration_decay: 0.5", GRADIENT),
        ("learner: {name: fixed, learning_rate: 0.05}", "learner.learning_rate: 0.05", GRADIENT),
        (
            "learner: {name: projected_gradient, exploration_until: 1.0}",
            "learner.exploration_until: 1.0",
            "learner.name: posterior",
        ),
        ("control: {solver: snopt, sqp_iterations: 1}", "control.sqp_iterations: 1", "control.solver: rti"),
        ("control: {solver: ipopt, qp_solver: osqp}", "control.qp_solver: osqp", "control.solver: rti"),
        ("control: {target_evidence: geometric}", "control.target_evidence: geometric", "learned_targets: true"),
        ("control: {target_sensitivity: identity}", "control.target_sensitivity: identity", "learned_targets: true"),
        (
            "control: {translation_rate: 0.01, learned_weights: true}",
            "control.translation_rate: 0.01",
            "control.learned_translation: true",
        ),
    ],
)
def test_a_setting_that_changes_nothing_is_refused_with_what_would_use_it(load_scenario, text, what, choice):
    with pytest.raises(BadInput) as caught:
        load_scenario(text)
    line = str(caught.value)
    assert line.startswith(f"mine.scenario.yaml: {what}, which changes nothing here; expected nothing, or ")
    assert choice in line


@pytest.mark.parametrize(
    "text",
    [
        "patient: {earlier_weights: [0.2, 0.2, 0.2, 0.2, 0.2], earlier_episodes: 1}",
        "patient: {earlier_weights: [], earlier_episodes: 0}",
        "learner: {name: projected_gradient, learning_rate: 0.05, exploration: 0.0, exploration_decay: 0.5}",
        "learner: {name: reference_gradient, learning_rate: 0.05}",
        "learner: {exploration_until: 1.0}",
        "learner: {name: random, learning_rate: 0.12, exploration_until: 0.03}",  # The defaults.
        "control: {sqp_iterations: 1, qp_solver: osqp}",
        "control: {solver: snopt, sqp_iterations: 20}",
        "control: {learned_targets: true, target_evidence: geometric}",
        "control: {learned_translation: true, translation_rate: 0.01}",
        "control: {target_evidence: fuzzy, translation_rate: 0.002}",
    ],
)
def test_a_setting_that_is_used_or_as_usual_is_not(load_scenario, text):
    load_scenario(text)


def test_what_changes_nothing_is_reset_and_nothing_else():
    scenario = Scenario()
    scenario.patient.earlier_weights, scenario.patient.noise = [0.2] * 5, 0.2
    scenario.learner.learning_rate, scenario.learner.exploration_until = 0.05, 0.5
    scenario.control.sqp_iterations, scenario.control.translation_rate, scenario.control.tolerance = 1, 0.01, 1e-3
    mut.reset_unused(scenario)
    usual = Scenario()
    assert scenario.patient == replace(usual.patient, noise=0.2)
    assert scenario.learner == replace(usual.learner, exploration_until=0.5)
    assert scenario.control == replace(usual.control, sqp_iterations=1, tolerance=1e-3)
    Validate(scenario)
