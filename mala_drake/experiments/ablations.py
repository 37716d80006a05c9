"""What each part of the system is worth, and what it can bear: one condition after another changed.

Every condition is a part of a scenario file, so anybody can run it alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from mala_drake.experiments.experiment import Changes
from mala_drake.experiments.experiment_kind import ExperimentKind, Size
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import Scenario

_GRADIENT = "projected_gradient"

ABLATIONS: Mapping[str, tuple[Changes, str]] = MappingProxyType(
    {
        "full": ({}, "the scenario as it is; ratings with the paper's noise of 0.1"),
        # Other learners.
        _GRADIENT: ({"learner": {"name": _GRADIENT}}, "the paper's learner"),
        "reference_gradient": (
            {"learner": {"name": "reference_gradient"}},
            "the paper's learner as its reference implementation has it: a falling step, averaging, a learned bias",
        ),
        "bandit": ({"learner": {"name": "bandit"}}, "UCB1 over six fixed weightings"),
        "uniform_weights": ({"learner": {"name": "fixed"}}, "nothing is learned: even weights in every episode"),
        "random_weights": ({"learner": {"name": "random"}}, "nothing is learned: other random weights in each episode"),
        # Parts left out.
        "no_exploration": (
            {"learner": {"name": "posterior", "exploration_until": 1.0}},
            "posterior, which plans with its best estimate always",
        ),
        "no_exploration_decay": (
            {"learner": {"name": _GRADIENT, "exploration_decay": 0.0}},
            "projected_gradient, whose exploration never falls",
        ),
        "crisp_grounding": (
            {"grounding": {"membership": "crisp"}},
            "an atom is true or false, without degrees in between",
        ),
        "no_learned_costs": (
            {"planner": {"learned_costs": False}},
            "the planner predicts what actions cost, and never learns what they did cost",
        ),
        "medication_only": ({"task": "medication"}, "every episode is a medication round"),
        "meal_only": ({"task": "meal"}, "every episode is a meal"),
        # Things that are harder.
        "rating_noise_0.05": ({"patient": {"noise": 0.05}}, "ratings with half the noise"),
        "rating_noise_0.2": ({"patient": {"noise": 0.2}}, "ratings with twice the noise"),
        "rating_noise_0.4": ({"patient": {"noise": 0.4}}, "ratings with four times the noise"),
        "clipped_ratings": ({"patient": {"clip": True}}, "ratings are cut to [1, 5]"),
        "missing_ratings": ({"patient": {"missing": 0.3}}, "three criteria in ten are left unrated"),
        "drifting_patient": (
            {"patient": {"earlier_weights": [0.1, 0.1, 0.3, 0.1, 0.4], "earlier_episodes": 10}},
            "for the first ten episodes the patient wants something else; what is learned is counted since",
        ),
        "dirichlet_initial_weights": (
            {"learner": {"name": _GRADIENT, "random_initial_weights": True}},
            "projected_gradient, which starts at random weights",
        ),
        "changing_risk": (
            {"world": {"risk_variation": 0.15}},
            "the risk that is met is U(0.85, 1.15) times what the planner expects, anew in each episode",
        ),
        "wrong_items_0": ({"world": {"wrong_item_probability": 0.0}}, "dispensers make no mistakes"),
        "wrong_items_0.3": ({"world": {"wrong_item_probability": 0.3}}, "three hand-overs in ten are of another item"),
    }
)
"""What each condition changes in the scenario, and what that means; the others are measured by the first one."""


def ablation_conditions(base: Scenario, names: Sequence[str] | None) -> Mapping[str, Changes]:  # noqa: ARG001
    """The conditions of these names, in the order of the table; all of them for None."""
    return {name: changes for name, (changes, _) in ABLATIONS.items() if names is None or name in names}


ABLATION_KIND = ExperimentKind(
    name="ablations",
    size=Size(profiles=("speed_oriented", "presentation_focused"), seeds=tuple(range(5)), episodes=20),
    full_size=Size(profiles=tuple(PROFILES), seeds=tuple(range(5)), episodes=40),
    condition_option="--conditions",
    condition_names=tuple(ABLATIONS),
    conditions=ablation_conditions,
    explanations=MappingProxyType({name: meaning for name, (_, meaning) in ABLATIONS.items()}),
)
