"""What to simulate: its fields, the file they are read from, and what they may be."""

from mala_drake.scenario.fields import (
    HORIZON_KINDS,
    TARGET_EVIDENCE,
    TARGET_SENSITIVITIES,
    ControlConfig,
    DisplacedPlaceConfig,
    GroundingConfig,
    LearnerConfig,
    ObstacleConfig,
    PatientConfig,
    PlannerConfig,
    RobotConfig,
    Scenario,
    WorldConfig,
)
from mala_drake.scenario.file import LoadScenario
from mala_drake.scenario.unused import reset_unused
from mala_drake.scenario.validation import Validate

__all__ = [
    "HORIZON_KINDS",
    "TARGET_EVIDENCE",
    "TARGET_SENSITIVITIES",
    "ControlConfig",
    "DisplacedPlaceConfig",
    "GroundingConfig",
    "LearnerConfig",
    "LoadScenario",
    "ObstacleConfig",
    "PatientConfig",
    "PlannerConfig",
    "RobotConfig",
    "Scenario",
    "Validate",
    "WorldConfig",
    "reset_unused",
]
