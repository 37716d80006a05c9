"""The learners: each a plain class on vectors, with a system beside it that puts it in the diagram."""

from mala_drake.learning.abstract_learner import AbstractLearner
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner
from mala_drake.learning.bandit import Bandit
from mala_drake.learning.convergence import CONVERGED_DISTANCE, convergence_episode, preference_distance
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.learning.cost_learner import CostLearner
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.learning.dynamics_learner import DynamicsLearner
from mala_drake.learning.fixed_weights import FixedWeights
from mala_drake.learning.information_bound import efficiency, weight_bound
from mala_drake.learning.make_learner import LEARNER_NAMES, make_learner
from mala_drake.learning.posterior import Posterior
from mala_drake.learning.preference_learner import PreferenceLearner
from mala_drake.learning.projected_gradient import ProjectedGradient
from mala_drake.learning.random_weights import RandomWeights
from mala_drake.learning.simplex import project_onto_simplex
from mala_drake.learning.target_estimator import TargetEstimator, TargetEvidence
from mala_drake.learning.target_learner import TargetLearner
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.learning.weight_learner import WeightLearner

__all__ = [
    "CONVERGED_DISTANCE",
    "LEARNER_NAMES",
    "AbstractLearner",
    "AbstractPreferenceLearner",
    "Bandit",
    "CostEstimator",
    "CostLearner",
    "DynamicsEstimator",
    "DynamicsLearner",
    "FixedWeights",
    "Posterior",
    "PreferenceLearner",
    "ProjectedGradient",
    "RandomWeights",
    "TargetEstimator",
    "TargetEvidence",
    "TargetLearner",
    "Transition",
    "TranslationEstimator",
    "WeightEstimator",
    "WeightLearner",
    "convergence_episode",
    "efficiency",
    "make_learner",
    "preference_distance",
    "project_onto_simplex",
    "weight_bound",
]
