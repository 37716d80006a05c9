"""The patient: true preferences, ratings, and the system that gives them."""

from mala_drake.patient.patient import Patient
from mala_drake.patient.profiles import PROFILES, profile_weights
from mala_drake.patient.rating import RatingHabits, expected_ratings, rate

__all__ = ["PROFILES", "Patient", "RatingHabits", "expected_ratings", "profile_weights", "rate"]
