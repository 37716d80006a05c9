"""Which scenarios can be simulated: every field that cannot is named in one line."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from mala_drake.control.qp.choice import QP_SOLVER_NAMES
from mala_drake.control.solver import SOLVER_NAMES
from mala_drake.errors import BadInput
from mala_drake.grounding.atom_memberships import MEMBERSHIP_NAMES
from mala_drake.learning.make_learner import LEARNER_NAMES, make_learner
from mala_drake.patient.profiles import PROFILES
from mala_drake.planning.care_tasks import TASK_NAMES
from mala_drake.preferences import validated_weights
from mala_drake.scenario.fields import HORIZON_KINDS, TARGET_EVIDENCE, TARGET_SENSITIVITIES, Scenario
from mala_drake.scenario.unused import refuse_unused
from mala_drake.ward.displacement import taken_place
from mala_drake.ward.items import all_items
from mala_drake.ward.models import ward_models
from mala_drake.ward.routes import BODY_RADIUS, GOAL_DISTANCE
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import Ward


def Validate(scenario: Scenario, *, where: str = "scenario") -> None:
    """Checks every field of a scenario, and its ward.

    Args:
        scenario: to be checked.
        where: begins what the error says; may be empty.

    Raises:
        BadInput: for the first field that cannot be simulated.
    """
    at = f"{where}: " if where else ""
    _finite(scenario, at)
    _check_names(scenario, at)
    _check_ranges(scenario, at)
    refuse_unused(scenario, at)
    _check_control_learners(scenario, at)
    for name, weights in (
        ("patient.true_weights", scenario.patient.true_weights),
        ("patient.earlier_weights", scenario.patient.earlier_weights),
        ("learner.initial_weights", scenario.learner.initial_weights),
    ):
        if weights:
            validated_weights(weights, where=at + name)
    if scenario.patient.earlier_episodes and not scenario.patient.earlier_weights:
        raise BadInput(at + "patient.earlier_weights", "none, for earlier_episodes", "the weights of those episodes")
    if scenario.learner.random_initial_weights and scenario.learner.initial_weights:
        raise BadInput(at + "learner.initial_weights", "given, and to be random", "one or the other")
    make_learner(scenario.settled_learner, where=at + "learner")
    ward = _checked_ward(scenario, at)
    kinds = sorted({item.kind for item in all_items(ward, ("medication",))})
    for i, kind in enumerate(scenario.world.wrong_items):
        _one_of(f"{at}world.wrong_items[{i}]", kind, kinds)
    _check_obstacles(scenario, ward, at)
    _check_displacements(scenario, ward, at)


def _finite(value: Any, at: str) -> None:
    """Refuses numbers that are not finite anywhere in the scenario."""
    for item in fields(value):
        entry = getattr(value, item.name)
        for i, element in enumerate(entry if isinstance(entry, list) else [entry]):
            place = f"{at}{item.name}" + (f"[{i}]" if isinstance(entry, list) else "")
            if is_dataclass(element):
                _finite(element, place + ".")
            elif isinstance(element, float) and not math.isfinite(element):
                raise BadInput(place, str(element), "a finite number")


def _one_of(at: str, value: str, names: Sequence[str]) -> None:
    if value not in names:
        raise BadInput(at, repr(value), "one of " + ", ".join(names))


def _check_names(scenario: Scenario, at: str) -> None:
    _one_of(at + "task", scenario.task, _task_choices())
    _one_of(at + "patient.profile", scenario.patient.profile, tuple(PROFILES))
    _one_of(at + "grounding.membership", scenario.grounding.membership, MEMBERSHIP_NAMES)
    _one_of(at + "learner.name", scenario.learner.name, LEARNER_NAMES)
    _one_of(at + "control.solver", scenario.control.solver, SOLVER_NAMES)
    _one_of(at + "control.qp_solver", scenario.control.qp_solver, QP_SOLVER_NAMES)
    _one_of(at + "control.horizon_kind", scenario.control.horizon_kind, HORIZON_KINDS)
    _one_of(at + "control.target_evidence", scenario.control.target_evidence, TARGET_EVIDENCE)
    _one_of(at + "control.target_sensitivity", scenario.control.target_sensitivity, TARGET_SENSITIVITIES)


def _task_choices() -> tuple[str, ...]:
    both = {"medication", "meal"} <= set(TASK_NAMES)
    return (*TASK_NAMES, "alternate") if both else tuple(TASK_NAMES)


def _check_ranges(scenario: Scenario, at: str) -> None:
    robot, world, patient, control = scenario.robot, scenario.world, scenario.patient, scenario.control
    ranges: tuple[tuple[str, float, float, float], ...] = (
        ("random_seed", scenario.random_seed, 0, math.inf),
        ("episodes", scenario.episodes, 1, 1_000_000),
        ("episode_time_limit", scenario.episode_time_limit, 1.0, 86_400.0),
        ("robot.hidden_truth", robot.hidden_truth, 0.0, 5.0),
        ("robot.gyroscopic_effect", robot.gyroscopic_effect, 0.0, 5.0),
        ("robot.initial_charge", robot.initial_charge, 0.0, 1.0),
        ("robot.position_noise", robot.position_noise, 0.0, 1.0),
        ("robot.yaw_noise", robot.yaw_noise, 0.0, 1.0),
        ("robot.velocity_noise", robot.velocity_noise, 0.0, 1.0),
        ("world.wrong_item_probability", world.wrong_item_probability, 0.0, 1.0),
        ("world.risk_variation", world.risk_variation, 0.0, 1.0),
        ("patient.noise", patient.noise, 0.0, 10.0),
        ("patient.missing", patient.missing, 0.0, 1.0),
        ("patient.earlier_episodes", patient.earlier_episodes, 0, math.inf),
        ("learner.learning_rate", scenario.learner.learning_rate, 0.0, 10.0),
        ("learner.exploration", scenario.learner.exploration, 0.0, 10.0),
        ("learner.exploration_decay", scenario.learner.exploration_decay, 0.0, 10.0),
        ("learner.exploration_until", scenario.learner.exploration_until, 1e-6, 1.0),
        ("planner.max_actions", scenario.planner.max_actions, 1, 10_000),
        ("planner.max_expansions", scenario.planner.max_expansions, 1, 100_000_000),
        ("control.horizon", control.horizon, 2, 200),
        ("control.tolerance", control.tolerance, 1e-10, 0.1),
        ("control.translation_rate", control.translation_rate, 1e-9, 1.0),
        ("control.sqp_iterations", control.sqp_iterations, 1, 1_000),
        ("control.step_budget", control.step_budget, 1, 100_000),
        ("control.waypoint_iterations", control.waypoint_iterations, 1, 100_000),
        ("control.tolerated_failures", control.tolerated_failures, 0, 1_000),
    )
    for name, value, low, high in ranges:
        _in_range(at + name, value, low, high)


def _in_range(at: str, value: float, low: float, high: float) -> None:
    if low <= value <= high:
        return
    try:
        told = f"{value:.10g}"
    except OverflowError:
        told = "a number of hundreds of digits"
    limits = f"a number >= {low:g}" if math.isinf(high) else f"a number from {low:g} to {high:.10g}"
    raise BadInput(at, told, limits)


def _check_control_learners(scenario: Scenario, at: str) -> None:
    """Who learns from simulated legs has to be able to differentiate them as they were driven."""
    control = scenario.control
    learned = {
        "learned_targets": control.learned_targets and control.target_sensitivity == "simulated",
        "learned_weights": control.learned_weights,
        "learned_translation": control.learned_translation,
    }
    names = [name for name, wanted in learned.items() if wanted]
    if names and control.hard_clearance:
        raise BadInput(
            at + "control.hard_clearance", f"true, with {names[0]}", "false: legs are differentiated with the penalty"
        )


def _checked_ward(scenario: Scenario, at: str) -> Ward:
    """The ward, once it is known that there is a home and that the robot fits wherever it is to stand."""
    # Not `Path.is_file`, which raises where a path is too long or has a null character.
    if scenario.ward and not os.path.isfile(scenario.ward):
        raise BadInput(at + "ward", repr(scenario.ward), "the path of a ward map, or nothing")
    ward = scenario.load_ward()
    where = Path(scenario.ward).name or "ward"
    ward_models(ward)  # Refuses furniture that cannot be built.
    if all(place.category != "home" for place in ward.places):
        raise BadInput(f"{where}: places", "none of category home", "a place where the robot starts")
    solid = (*ward.furniture, *ward.walls)
    distances = ShapeDistances([piece.shape for piece in solid])
    for i, place in enumerate(ward.places):
        gaps = distances([place.x, place.y])
        nearest = int(gaps.argmin())
        if gaps[nearest] < BODY_RADIUS:
            raise BadInput(
                f"{where}: places[{i}] {place.name}",
                f"{solid[nearest].name} is {max(float(gaps[nearest]), 0.0):.2f} m from it",
                f"{BODY_RADIUS} m or more to anything solid, for the robot to stand there",
            )
    return ward


def _check_obstacles(scenario: Scenario, ward: Ward, at: str) -> None:
    reach = ward.half_extent
    home = next(place for place in ward.places if place.category == "home")
    names = [obstacle.name for obstacle in scenario.world.obstacles]
    for i, (config, shape) in enumerate(zip(scenario.world.obstacles, scenario.unmapped_shapes, strict=True)):
        where = f"{at}world.obstacles[{i}]"
        if not config.name or config.name in names[:i]:
            raise BadInput(f"{where}.name", repr(config.name), "a name that no other obstacle has")
        if min(config.half_length, config.half_width, config.height) <= 0:
            raise BadInput(where, "a size that is not positive", "half_length, half_width and height above 0")
        for name in ("x", "y", "half_length", "half_width", "height"):
            _in_range(f"{where}.{name}", getattr(config, name), -reach if name in ("x", "y") else 0.0, reach)
        if ShapeDistances([shape])([home.x, home.y])[0] < BODY_RADIUS:
            raise BadInput(where, f"stands on the robot at {home.name}", "an obstacle that leaves the robot free")


def _check_displacements(scenario: Scenario, ward: Ward, at: str) -> None:
    """The robot has to fit wherever a place is and wherever the map says it is, by the map and really."""
    moved = scenario.world.displaced_places
    known = [place.name for place in ward.places if place.category != "home"]
    names = [*(config.place for config in moved), *scenario.world.randomly_displaced]
    for i, name in enumerate(names):
        field_name = f"displaced_places[{i}].place" if i < len(moved) else f"randomly_displaced[{i - len(moved)}]"
        _one_of(f"{at}world.{field_name}", name, known)
        if name in names[:i]:
            raise BadInput(f"{at}world.{field_name}", f"{name!r} again", "each place once")
    taken = taken_place(ward, scenario.displacements(ward), scenario.unmapped_shapes)
    if names and taken is not None:
        place, shape = taken
        raise BadInput(
            f"{at}world.displaced_places",
            f"{place.name} at ({place.x:.2f}, {place.y:.2f}) is taken by {shape.name}",
            f"{GOAL_DISTANCE:.2f} m or more to anything solid, wherever a place is and wherever the map says it is",
        )
