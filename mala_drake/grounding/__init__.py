"""Fuzzy grounding: memberships, fuzzy logic, defuzzification, and the system that puts them in the diagram."""

from mala_drake.grounding.aggregation import fuzzy_state, state_truth, state_truth_gradient
from mala_drake.grounding.alpha_cut import AlphaCut
from mala_drake.grounding.best_state import BestState, best_state
from mala_drake.grounding.defuzzification import (
    INSTANTIATION_THRESHOLD,
    AbstractDefuzzification,
    ArgmaxThreshold,
    Hysteresis,
    Threshold,
)
from mala_drake.grounding.fuzzy_grounding import FuzzyGrounding
from mala_drake.grounding.gaussian import Gaussian
from mala_drake.grounding.location import LocationMembership
from mala_drake.grounding.location_grounding import IN_TRANSIT, LocationGrounding
from mala_drake.grounding.lukasiewicz_norms import LukasiewiczNorms
from mala_drake.grounding.membership import AbstractMembership
from mala_drake.grounding.minimum_norms import MinimumNorms
from mala_drake.grounding.mismatch import (
    location_error,
    location_error_gradient,
    location_mismatch,
    reach_error,
    state_mismatch,
    state_mismatch_gradient,
)
from mala_drake.grounding.norms import AbstractNorms, negation
from mala_drake.grounding.predicates import (
    AbstractPredicateMembership,
    ChargeMembership,
    Observation,
    ProximityMembership,
)
from mala_drake.grounding.product_norms import ProductNorms
from mala_drake.grounding.saturated_ramp import SaturatedRamp
from mala_drake.grounding.set_operations import Complement, Intersection, Union
from mala_drake.grounding.sigmoid import Sigmoid
from mala_drake.grounding.trapezoidal import Trapezoidal
from mala_drake.grounding.triangular import Triangular
from mala_drake.grounding.truncated_annulus import TruncatedAnnulus

__all__ = [
    "INSTANTIATION_THRESHOLD",
    "IN_TRANSIT",
    "AbstractDefuzzification",
    "AbstractMembership",
    "AbstractNorms",
    "AbstractPredicateMembership",
    "AlphaCut",
    "ArgmaxThreshold",
    "BestState",
    "ChargeMembership",
    "Complement",
    "FuzzyGrounding",
    "Gaussian",
    "Hysteresis",
    "Intersection",
    "LocationGrounding",
    "LocationMembership",
    "LukasiewiczNorms",
    "MinimumNorms",
    "Observation",
    "ProductNorms",
    "ProximityMembership",
    "SaturatedRamp",
    "Sigmoid",
    "Threshold",
    "Trapezoidal",
    "Triangular",
    "TruncatedAnnulus",
    "Union",
    "best_state",
    "fuzzy_state",
    "location_error",
    "location_error_gradient",
    "location_mismatch",
    "negation",
    "reach_error",
    "state_mismatch",
    "state_mismatch_gradient",
    "state_truth",
    "state_truth_gradient",
]
