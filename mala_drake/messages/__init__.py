"""The immutable values on the diagram's abstract ports.

Drake deep-copies abstract state at each unrestricted update and abstract values at each evaluation; a frozen message
returns itself, so the copy is free. A message that starts something carries a sequence number that grows by one with
each new start; its receiver acts once on each. Sequence 0 means "nothing yet".
"""

from mala_drake.messages.actions import Action, ActionKind, ActionReport, Outcome, PlanMessage, Task, TaskReport
from mala_drake.messages.commands import ArmCommand, MagnetCommand, PredictedTrajectory
from mala_drake.messages.evaluation import ActionEvaluation, ActionFeatures, EpisodeReport, Ratings
from mala_drake.messages.learned import (
    DrivenLeg,
    LearnedCosts,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    Preferences,
    SensitivitySource,
)
from mala_drake.messages.message import Atom, Message
from mala_drake.messages.observations import (
    Memberships,
    Obstacles,
    PlaceMismatch,
    RobotState,
    Shape,
    SymbolicState,
    WorldFacts,
)

__all__ = [
    "Action",
    "ActionEvaluation",
    "ActionFeatures",
    "ActionKind",
    "ActionReport",
    "ArmCommand",
    "Atom",
    "DrivenLeg",
    "EpisodeReport",
    "LearnedCosts",
    "LearnedDynamics",
    "LearnedTargets",
    "LearnedWeights",
    "MagnetCommand",
    "Memberships",
    "Message",
    "Obstacles",
    "Outcome",
    "PlaceMismatch",
    "PlanMessage",
    "PredictedTrajectory",
    "Preferences",
    "Ratings",
    "RobotState",
    "SensitivitySource",
    "Shape",
    "SymbolicState",
    "Task",
    "TaskReport",
    "WorldFacts",
]
