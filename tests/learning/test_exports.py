"""Whoever learns something can be imported from the package itself."""

from __future__ import annotations

import inspect
import pkgutil
from importlib import import_module

from pydrake.systems.framework import LeafSystem

import mala_drake.learning as mut


def classes():
    """Every class that the package's modules define."""
    for info in pkgutil.iter_modules(mut.__path__, mut.__name__ + "."):
        module = import_module(info.name)
        yield from (item for item in vars(module).values() if inspect.isclass(item) and item.__module__ == info.name)


def test_every_learner_and_every_system_of_one_is_exported():
    learners = {item.__name__ for item in classes() if issubclass(item, mut.AbstractLearner)}
    systems = {
        item.__name__ for item in classes() if issubclass(item, LeafSystem) and not item.__subclasses__()
    }  # Those that others derive from are no learners yet.
    assert {"Posterior", "TargetEstimator", "WeightEstimator", "TranslationEstimator"} <= learners
    assert {"PreferenceLearner", "CostLearner", "DynamicsLearner", "TargetLearner", "WeightLearner"} == systems
    assert learners | systems <= set(mut.__all__)


def test_what_is_exported_is_there():
    assert sorted(mut.__all__) == sorted(set(mut.__all__))
    assert all(hasattr(mut, name) for name in mut.__all__)
