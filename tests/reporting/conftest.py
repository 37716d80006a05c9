"""A small diagram whose graph is known by heart, and results of experiments that nobody had to simulate."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder, ConstantVectorSource, Gain

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.experiments.episode_record import EpisodeFile, EpisodeRecord, by_criterion
from mala_drake.experiments.experiment import Experiment
from mala_drake.learning.convergence import preference_distance
from mala_drake.learning.projected_gradient import ProjectedGradient
from mala_drake.patient.profiles import PROFILES
from mala_drake.patient.rating import RatingHabits, rate
from mala_drake.randomness import keyed_generator
from mala_drake.scenario import DisplacedPlaceConfig, Scenario


def _nested_diagram() -> Diagram:
    """source -> inner(gain, gain) -> adder, whose second input and whose sum are the whole diagram's ports."""
    inside = DiagramBuilder()
    first = inside.AddNamedSystem("first", Gain(2.0, 1))
    second = inside.AddNamedSystem("second", Gain(3.0, 1))
    inside.Connect(first.get_output_port(), second.get_input_port())
    inside.ExportInput(first.get_input_port(), "command")
    inside.ExportOutput(second.get_output_port(), "amplified")
    inner = inside.Build()
    inner.set_name("inner")

    builder = DiagramBuilder()
    source = builder.AddNamedSystem("source", ConstantVectorSource([1.0]))
    builder.AddSystem(inner)
    adder = builder.AddNamedSystem("adder", Adder(2, 1))
    builder.Connect(source.get_output_port(), inner.GetInputPort("command"))
    builder.Connect(inner.GetOutputPort("amplified"), adder.get_input_port(0))
    builder.ExportInput(adder.get_input_port(1), "disturbance")
    builder.ExportOutput(adder.get_output_port(), "total")
    diagram = builder.Build()
    diagram.set_name("outer")
    return diagram


@pytest.fixture
def make_nested_diagram() -> Callable[[], Diagram]:
    """Each call builds the diagram anew."""
    return _nested_diagram


_MEDICATION = {
    ("north", "A", "left"): (0.54, 0.78, 0.50, 0.56, 0.48),
    ("north", "A", "right"): (0.59, 0.55, 0.56, 0.75, 0.33),
    ("south", "B", "left"): (0.75, 0.66, 0.70, 0.57, 0.48),
    ("south", "B", "right"): (0.84, 0.41, 0.86, 0.71, 0.33),
}
"""Features by pharmacy, supply room and bedside."""

_MEAL = {
    ("sandwich", "left"): (0.45, 0.60, 0.35, 0.50, 0.70),
    ("salad", "right"): (0.60, 0.45, 0.45, 0.40, 0.50),
    ("hot_meal", "right"): (0.85, 0.50, 0.90, 0.45, 0.25),
}
"""Features by dish and bedside."""


def _medication_actions(pharmacy, supply, side):
    at_pharmacy, at_supply = f"pharmacy_{pharmacy}", f"supply_{supply.lower()}"
    return [
        f"(go_to_{at_pharmacy} robot1 home)",
        f"(collect_med_antibiotic robot1 {at_pharmacy})",
        f"(check_medication_correct robot1 {at_pharmacy} med_antibiotic)",
        f"(go_to_{at_supply} robot1 {at_pharmacy})",
        f"(collect_supp_vitamin_d robot1 {at_supply})",
        f"(check_supplement_correct robot1 {at_supply} supp_vitamin_d)",
        f"(approach_{side}_to_bed robot1 {at_supply})",
        f"(deliver_on_bedside_table_{side} robot1)",
    ]


def _episode(learner, state, *, episode, task, profile, seed, rating_noise):
    """A record of the patient's true formula and the learner's true update, on features from a table."""
    generator = keyed_generator(seed, episode, "simulated " + profile)
    weights = learner.planning_weights(state, generator)
    table = _MEDICATION if task == "medication" else _MEAL
    choice = min(table, key=lambda each: np.dot(weights, table[each]))
    features = np.clip(np.array(table[choice]) + 0.01 * generator.standard_normal(5), 0.0, 1.0)
    ratings = rate(features, PROFILES[profile], generator, RatingHabits(noise=rating_noise))
    after = learner.update(state, ratings=ratings, features=features)
    deviation = learner.deviation(after)
    record = EpisodeRecord(
        episode=episode,
        task=task,
        profile=profile,
        seed=seed,
        success=True,
        failure=None,
        actions=_medication_actions(*choice) if task == "medication" else [f"(choose_{choice[0]} robot1)"],
        plan_variant="/".join((*choice[:2], "med-supp", choice[2]) if task == "medication" else choice),
        plan_cost=float(np.dot(weights, table[choice])),
        replans=8,
        features=by_criterion(features),
        predicted_features=by_criterion(table[choice]),
        ratings=list(ratings),
        weights_before=list(learner.estimate(state)),
        weights_after=list(learner.estimate(after)),
        weights_std=None if deviation is None else list(deviation),
        distance_to_true=preference_distance(learner.estimate(after), PROFILES[profile]),
        sim_time_s=160.0 * float(features[0]),
        solver="snopt",
        mpc_solves=250,
        mpc_failures=0,
        mpc_not_converged=0,
        min_clearance_m=0.22,
        collisions=0,
        terminal_errors_m=[0.016, 0.014, 0.011],
        terminal_yaw_errors_rad=[0.01, 0.01, 0.02],
        terminal_speeds_m_s=[0.0, 0.0, 0.0],
        leg_outcomes=["success"] * 3,
        mismatches=0,
        battery_start=1.0,
        battery_end=1.0 - float(features[2]),
        timing={"wall_s": 5.9, "mpc_median_ms": 7.5},
    )
    return record, after


def _simulate_results(
    folder,
    *,
    profiles=tuple(PROFILES),
    seeds=(0, 1),
    episodes=4,
    condition="",
    tasks=("medication",),
    change=None,
    **learner,
):
    """Writes runs as an experiment lays them out; `change` may alter a record before it is written."""
    for profile in profiles:
        for seed in seeds:
            method = ProjectedGradient(**learner)
            state = method.initial_state()
            file = EpisodeFile(folder / condition / profile / f"seed_{seed}")
            for episode in range(episodes):
                record, state = _episode(
                    method,
                    state,
                    episode=episode,
                    task=tasks[episode % len(tasks)],
                    profile=profile,
                    seed=seed,
                    rating_noise=0.1,
                )
                file.append(change(record) or record if change else record)
            file.close()
    return folder


@pytest.fixture(scope="session")
def simulate_results() -> Callable[..., Path]:
    """Writes the results of an experiment without the physics: real ratings, real learner, features from a table."""
    return _simulate_results


_INNER_ACTIONS = {
    "(go_to_pharmacy_north robot1 home)": (-0.12, 40.0, 0.0, 0.002),
    "(collect_med_antibiotic robot1 pharmacy_north)": (-0.03, None, 0.0, 0.0001),
    "(approach_left_to_bed robot1 pharmacy_north)": (-0.15, 60.0, 0.0, -0.006),
    "(deliver_on_bedside_table_left robot1)": (-0.05, None, 1.0, 0.0),
}
"""By action: R^e, R^o, E^psi in an episode with another item than asked for, E^C in the first episode."""


def _with_actions(record, *, wrong_items=()):
    """A record of four actions, whose cost mismatch halves from episode to episode."""
    entries = [
        {
            "action": action,
            "outcome": "success",
            "external_reward": reward,
            "closed_loop_cost": cost,
            "state_mismatch": state if record.episode in wrong_items else 0.0,
            "cost_mismatch": mismatch / 2**record.episode,
        }
        for action, (reward, cost, state, mismatch) in _INNER_ACTIONS.items()
    ]
    return replace(record, executed_actions=entries)


def _with_learned_control(record):
    """A record in which the controller has learned everything that it can, a little more in each episode."""
    step = 1 + record.episode
    coefficients = {
        "lateral_damping": 5.0 + step,
        "lateral_coupling": -0.02 * (5.0 + step),
        "yaw_coupling": 0.35,
        "propulsion_gain": 0.955,
        "brake_gain": 1.0,
        "yaw_gain": 0.95 + 0.001 * record.seed,
    }
    gains = DEFAULT_TRANSLATION.gains
    gains[2, 4] += 0.01 * step
    return replace(
        _with_actions(record),
        learned_dynamics={name: [value, 0.02 / step] for name, value in coefficients.items()},
        dynamics_errors={"nominal": [0.004, 0.002, 0.01], "learned": [0.002, 0.001, 0.01 / (4 * step)]},
        learned_weights={"patient_bed_left": [1.0, 1.0, 2.0**step, 0.5**step]} if record.episode else {},
        learned_translation=gains.tolist() if record.episode else [],
    )


@pytest.fixture(scope="session")
def with_actions() -> Callable[..., EpisodeRecord]:
    """Gives a record executed actions; in the episodes `wrong_items` the last one has surprised the robot."""
    return _with_actions


@pytest.fixture(scope="session")
def with_learned_control() -> Callable[[EpisodeRecord], EpisodeRecord]:
    """Gives a record executed actions and a controller that learns."""
    return _with_learned_control


DISPLACED = {"pantry": (-0.5, 1.9), "patient_bed_left": (-1.06, 1.06)}
"""Metres by place, for each seed the same."""


def _displaced_leg(place, mapped, off, *, mismatch, moved, outcome="success"):
    """A leg after which the target is `off` from the true place."""
    x, y = (mapped[i] + DISPLACED[place][i] + off[i] for i in range(2))
    distance = float(np.hypot(*off))
    entry = {"place": place, "outcome": outcome, "mismatch": mismatch, "closed_loop_cost": 10.0, "moved": moved}
    return {**entry, "x": x, "y": y, "distance_to_true_m": distance}


def _simulate_targets(folder, legs, *, seeds=(0, 1), change=None):
    """Writes runs with displaced places.

    Args:
        folder: to write to.
        legs: by condition, a list an episode of (place, offset of the target from the true place, mismatch, moved).
        seeds: of the runs.
        change: alters a record before it is written.
    """
    base = Scenario(task="alternate", episodes=max(map(len, legs.values())))
    base.world.displaced_places = [DisplacedPlaceConfig(place, *by) for place, by in DISPLACED.items()]
    ward = base.load_ward()
    mapped = {place: (ward.place[place].x, ward.place[place].y) for place in DISPLACED}
    experiment = Experiment("targets", base, {name: {} for name in legs}, ("comfort_focused",), seeds)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.json").write_text(json.dumps(experiment.to_json()))
    for condition, episodes in legs.items():

        def displace(record, episodes=episodes):
            entries = [
                _displaced_leg(place, mapped[place], off, mismatch=mismatch, moved=moved)
                for place, off, mismatch, moved in episodes[record.episode]
            ]
            record = replace(record, displaced_legs=entries)
            return change(record) if change else record

        _simulate_results(
            folder,
            profiles=("comfort_focused",),
            seeds=seeds,
            episodes=len(episodes),
            condition=condition,
            change=displace,
        )
    return folder


@pytest.fixture(scope="session")
def simulate_targets() -> Callable[..., Path]:
    """Writes the results of an experiment on displaced targets, with legs as told."""
    return _simulate_targets
