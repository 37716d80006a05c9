"""The paper's experiment on targets: places that are not where the map says, found by driving to them.

Paper, Sec. "Learning Continuous Target Parameters from Symbolic-Control Mismatches". Each seed displaces the places in
another way. Target by target, `summary.json` tells after how many updates the mismatch was gone and how far the learned
target is from the true one. Two conditions are ablations of the full system, in the same displaced wards: "identity"
learns targets without the closed-loop sensitivity, and "outer loop only" has none of the learners of the inner loop.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from mala_drake.experiments.experiment import Changes
from mala_drake.experiments.experiment_kind import ExperimentKind, Size
from mala_drake.scenario import Scenario

DISPLACED = ("pantry", "prep_station", "quality_check", "patient_bed_left")
"""The paper's four, unless the scenario names others."""

_CONDITIONS: Mapping[str, tuple[Changes, str]] = MappingProxyType(
    {
        "full": (
            {"control": {"learned_targets": True, "target_evidence": "geometric", "learned_dynamics": True}},
            "everything is learned: the patient's wishes, what actions cost, targets (as under geometric) and the "
            "dynamics of the controller's model",
        ),
        "geometric": (
            {"control": {"learned_targets": True, "target_evidence": "geometric"}},
            "targets are learned from the missing membership and from the place as it is seen; the model is nominal",
        ),
        "fuzzy": (
            {"control": {"learned_targets": True, "target_evidence": "fuzzy"}},
            "targets are learned from missing memberships alone: of being at the place, and of having its things "
            "within reach; the model is nominal",
        ),
        "identity": (
            {
                "control": {
                    "learned_targets": True,
                    "target_evidence": "geometric",
                    "target_sensitivity": "identity",
                    "learned_dynamics": True,
                }
            },
            "as full, but the end of a leg is taken to move as its target does, whatever the leg simulated in closed "
            "loop would say",
        ),
        "outer_loop_only": (
            {"control": {"learned_targets": False, "learned_dynamics": False}},
            "the planner learns, the controller does not: the patient's wishes and what actions cost are learned, but "
            "legs end where the map says, and the model is nominal",
        ),
    }
)


def target_conditions(base: Scenario, names: Sequence[str] | None) -> Mapping[str, Changes]:
    """The conditions of these names, in the order of the table; all of them for None."""
    told = base.world.displaced_places or base.world.randomly_displaced
    places: Changes = {} if told else {"world": {"randomly_displaced": list(DISPLACED)}}
    return {name: {**places, **changes} for name, (changes, _) in _CONDITIONS.items() if names is None or name in names}


TARGETS = ExperimentKind(
    name="targets",
    size=Size(profiles=("comfort_focused",), seeds=tuple(range(5)), episodes=6),
    condition_option="--conditions",
    condition_names=tuple(_CONDITIONS),
    conditions=target_conditions,
    explanations=MappingProxyType({name: meaning for name, (_, meaning) in _CONDITIONS.items()}),
)
