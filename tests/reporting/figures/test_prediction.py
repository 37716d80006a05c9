"""The errors of prediction that the picture shows."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mala_drake.reporting.figures import prediction as mut
from mala_drake.reporting.results import load_results


@pytest.fixture
def record(tmp_path, simulate_results):
    simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    found = load_results(tmp_path).runs[0].final
    return replace(found, predicted_features={"time": 0.3, "safety": 0.6}, features={"time": 0.5, "battery": 0.4})


def test_an_error_has_no_sign(record):
    assert mut.prediction_error(record, "time") == pytest.approx(0.2)
    swapped = replace(record, predicted_features=record.features, features=record.predicted_features)
    assert mut.prediction_error(swapped, "time") == pytest.approx(0.2)


@pytest.mark.parametrize("criterion", ["safety", "battery", "approach"])
def test_what_was_not_measured_or_not_predicted_has_no_error(record, criterion):
    assert math.isnan(mut.prediction_error(record, criterion))


def test_an_unfinished_task_has_no_error(record):
    assert math.isnan(mut.prediction_error(replace(record, success=False), "time"))
