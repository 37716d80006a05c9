"""The whole stack with learned weights: legs come to cost what the planner predicted of them.

The planner's predictions stay as they are (it learns no costs), so that what falls is the weights' doing. The patient
cares for the battery most, where the controller's weights have the most to say: the charge of a leg is smooth in them.
The time of a leg is not, since it ends with a tick.
"""

from __future__ import annotations

import numpy as np
import pytest

from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation


def scenario_of(episodes, **control):
    scenario = Scenario(episodes=episodes)
    scenario.planner.learned_costs = False
    # The same way in every episode.
    scenario.world.wrong_item_probability = 0.0
    scenario.learner.name, scenario.learner.initial_weights = "fixed", [0.1, 0.1, 0.6, 0.1, 0.1]
    for name, value in control.items():
        setattr(scenario.control, name, value)
    return scenario


def run(episodes, **control):
    scenario = scenario_of(episodes, **control)
    station, carried, records = MakeCareStation(scenario), Carried(), []
    for episode in range(episodes):
        record, carried = simulate_episode(station, scenario, episode=episode, carried=carried)
        records.append(record)
    return records


def mismatch(record):
    """The sum of |E^C| over the legs of an episode."""
    legs = [entry for entry in record.executed_actions if entry["closed_loop_cost"] is not None]
    assert len(legs) == 3
    return sum(abs(leg["cost_mismatch"]) for leg in legs)


@pytest.mark.slow
def test_the_mismatch_falls_with_learned_weights_and_stays_without():
    without = [mismatch(record) for record in run(2)]
    records = run(4, learned_weights=True)
    learned = [mismatch(record) for record in records]
    assert without[1] == pytest.approx(without[0], rel=0.01)
    assert learned[0] == pytest.approx(without[0], rel=0.05)
    assert learned[-1] < 0.6 * without[-1]
    assert all(record.success and record.collisions == 0 for record in records)
    factors = np.array(list(records[-1].learned_weights.values()))
    assert factors.shape == (3, 4)
    assert np.abs(np.log(factors)).max(axis=1).min() > 0.1
    assert factors.min() >= 0.25 - 1e-9
    assert factors.max() <= 4.0 + 1e-9


@pytest.mark.slow
def test_the_translation_moves_a_little_with_each_leg_and_is_recorded():
    records = run(2, learned_translation=True)
    start = TranslationEstimator().translation(TranslationEstimator().initial_state()).gains
    first, second = (np.array(record.learned_translation) - start for record in records)
    assert 0.0 < np.linalg.norm(first) < np.linalg.norm(second) < 0.6
    assert mismatch(records[1]) < mismatch(records[0])
    assert records[0].learned_weights is None


def test_a_resumed_run_goes_on_bit_for_bit():
    scenario = scenario_of(2, learned_weights=True, learned_translation=True)
    station = MakeCareStation(scenario)
    first, carried = simulate_episode(station, scenario, episode=0, carried=Carried())
    assert len(first.learned_weights) == 3
    start = TranslationEstimator().translation(TranslationEstimator().initial_state()).gains
    assert np.linalg.norm(np.array(first.learned_translation) - start) > 0.0
    resumed = Carried.from_json(carried.to_json(), where="checkpoint")
    records = []
    for diagram, before in ((station, carried), (MakeCareStation(scenario), resumed)):
        record, after = simulate_episode(diagram, scenario, episode=1, carried=before)
        record.timing.clear()
        records.append((record.to_json(), after))
    assert records[0] == records[1]
    assert records[0][1].learners["weight_learner"] != carried.learners["weight_learner"]
