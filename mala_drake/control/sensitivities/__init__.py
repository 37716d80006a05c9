"""Derivatives of MPC solutions, policies, values and closed loops with respect to parameters and states."""

from __future__ import annotations

from .analysis import PolicySensitivity, SensitivityAnalysis
from .closed_loop import ClosedLoop, ClosedLoopRun
from .columns import GROUPS, INITIAL_STATE, LOWER, UPPER, Columns
from .kkt_point import KktPoint
from .leg_parameters import ConstantParameters, LegParameters, ScheduledParameters, StepParameters
from .leg_sensitivity import AdjointSensitivity, ForwardSensitivity, adjoint, forward
from .primal_dual_sensitivity import PrimalDualSensitivity
from .regularity import Regularity
from .simulation_model import SimulationModel
from .value_functions import Value, ValueFunctions

__all__ = [
    "GROUPS",
    "INITIAL_STATE",
    "LOWER",
    "UPPER",
    "AdjointSensitivity",
    "ClosedLoop",
    "ClosedLoopRun",
    "Columns",
    "ConstantParameters",
    "ForwardSensitivity",
    "KktPoint",
    "LegParameters",
    "PolicySensitivity",
    "PrimalDualSensitivity",
    "Regularity",
    "ScheduledParameters",
    "SensitivityAnalysis",
    "SimulationModel",
    "StepParameters",
    "Value",
    "ValueFunctions",
    "adjoint",
    "forward",
]
