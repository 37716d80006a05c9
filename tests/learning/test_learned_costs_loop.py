"""Planner, executed actions and cost learner together: predictions come true, and plans are chosen by the truth."""

import numpy as np
import pytest

from mala_drake.experiments.run import RunOptions, run_scenario
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.messages import Action, ActionFeatures, ActionKind, Outcome, SymbolicState
from mala_drake.planning import Planner
from mala_drake.planning.care_tasks import CareTask
from mala_drake.scenario import Scenario
from mala_drake.ward.cost_parameters import LEG_COSTS, observed_parameters
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()
CARE = CareTask("medication", WARD)
WEIGHTS = (0.50, 0.12, 0.14, 0.14, 0.10)


class Hospital:
    """Rounds in a ward whose legs do not take what the map predicts, driven by the plans of a planner that learns."""

    def __init__(self, factors, *, noise=0.0, seed=0):
        self.truth = {
            name: value * factors.get(name[-1], 1.0) if name[0] in LEG_COSTS else value
            for name, value in CARE.predictions.items()
        }
        self._noise, self._generator = noise, np.random.default_rng(seed)
        self.learner = CostEstimator(CARE.predictions)
        self.state = self.learner.initial_state()
        self._planner = Planner(CARE.planning_task)

    def round(self):
        """One episode: its plan, and predicted and measured features summed over its actions."""
        state, actions = self._state(), ()
        plan = self._planner.solve(state, WEIGHTS)
        predicted, measured = np.zeros(5), np.zeros(5)
        for sequence, text in enumerate(plan.actions, start=1):
            after = CARE.planning_task.apply(state, text)
            predicted += CARE.features(state, text)
            measured += CARE.features(state.with_fluents(self.truth), text)
            self._learn(CARE.action(text, state, after, sequence=sequence))
            state, actions = after, (*actions, text)
        return actions, predicted, measured

    def _state(self):
        atoms = [("available", item.kind, item.place) for item in all_items(WARD, ("medication",))]
        observed = SymbolicState(tuple(sorted([*atoms, ("at", "robot1", "home")])), "home", 1.0)
        learned = self.learner.learned(self.state)
        return CARE.observed_state(observed, (0.0, 0.0, 0.0), standing_at="home", learned=learned)

    def _learn(self, action: Action):
        if action.kind is ActionKind.MOVE:
            way = (action.previous_place.lower(), action.place.lower())
            scatter = 1.0 + self._noise * self._generator.standard_normal(4)
            costs = [self.truth[(name, *way)] * each for name, each in zip(LEG_COSTS, scatter, strict=True)]
            features = ActionFeatures(action, Outcome.SUCCESS, *costs)
            self.state = self.learner.update(self.state, observed_parameters(features))

    def best_actions(self):
        """What a planner that knows the truth would do."""
        return self._planner.solve(self._state().with_fluents(self.truth), WEIGHTS).actions


def test_the_error_of_predictions_falls_over_episodes():
    everywhere = {place.name.lower(): 1.15 for place in WARD.places}
    hospital = Hospital(everywhere, noise=0.02)
    errors = [np.abs(predicted - measured).sum() for _, predicted, measured in (hospital.round() for _ in range(12))]
    assert errors[0] > 0.15
    assert errors[2] < 0.5 * errors[0]
    assert max(errors[8:]) < 0.12 * errors[0]


def test_where_the_map_misleads_the_best_round_is_found_by_driving():
    hospital = Hospital({"pharmacy_north": 1.6, "supply_a": 1.3})
    first, *_, last = (hospital.round()[0] for _ in range(15))
    best = hospital.best_actions()
    assert first != best
    assert last == best


def test_where_the_map_is_right_learning_changes_nothing():
    hospital = Hospital({}, noise=0.0)
    rounds = [hospital.round() for _ in range(3)]
    assert all(actions == hospital.best_actions() for actions, _, _ in rounds)
    assert all(predicted == pytest.approx(measured, abs=1e-5) for _, predicted, measured in rounds)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["safety_first", "energy_conscious"])
def test_on_the_physics_the_error_of_predictions_falls_over_episodes(profile):
    scenario = Scenario(episodes=4)
    scenario.world.wrong_item_probability = 0.0
    scenario.control.solver = "rti"
    scenario.patient.profile = profile
    scenario.learner.name = "fixed"
    scenario.learner.initial_weights = list(scenario.true_weights)
    records = []

    class Collector:
        def on_action(self, *_):
            pass

        def on_episode(self, record):
            records.append(record)

    run_scenario(scenario, RunOptions(out=None), watcher=Collector())
    errors = [
        sum(abs(record.predicted_features[name] - record.features[name]) for name in record.features)
        for record in records
    ]
    assert all(record.success for record in records)
    assert errors[0] > 0.03
    assert errors[1] < 0.6 * errors[0]
    assert errors[3] < 0.3 * errors[0]
