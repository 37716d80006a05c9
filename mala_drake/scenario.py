"""What to simulate: one YAML file of plain fields, each with a default, all of it validated before anything runs.

Drake's YAML reader looks at the fields' types themselves, so annotations in this module are not postponed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mala_drake.configuration import load_typed
from mala_drake.control.solver import SOLVER_NAMES
from mala_drake.errors import BadInput
from mala_drake.grounding.atom_memberships import MEMBERSHIP_NAMES
from mala_drake.learning.make_learner import LEARNER_NAMES, make_learner
from mala_drake.messages import Shape
from mala_drake.patient.profiles import PROFILES, profile_weights
from mala_drake.planning.care_tasks import TASK_NAMES
from mala_drake.preferences import CRITERIA, validated_weights
from mala_drake.randomness import keyed_generator
from mala_drake.resources import models_folder
from mala_drake.ward.displacement import Displacement, displaced_ward, draw_displacements, taken_place
from mala_drake.ward.items import all_items
from mala_drake.ward.models import ward_models
from mala_drake.ward.routes import BODY_RADIUS, GOAL_DISTANCE
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import LoadWard, Ward

HORIZON_KINDS = ("receding", "shrinking")
TARGET_EVIDENCE = ("fuzzy", "geometric")


@dataclass
class ObstacleConfig:
    """Something that stands in the ward and is not on its map: an upright box on the floor."""

    name: str = "trolley"
    x: float = 0.0  # Metres.
    y: float = 0.0  # Metres.
    yaw: float = 0.0  # Radians.
    half_length: float = 0.6  # Metres along its own x.
    half_width: float = 0.35  # Metres along its own y.
    height: float = 1.0  # Metres.


@dataclass
class DisplacedPlaceConfig:
    """A place that is not where the map says; its furniture stands in front of it as ever."""

    place: str = ""
    dx: float = 0.0  # Metres.
    dy: float = 0.0  # Metres.


@dataclass
class RobotConfig:
    """The physical robot, and what the controller's model does not know about it."""

    hidden_truth: float = 1.0  # Scale of the errors of mass and wheel radii; 0 is the nominal robot.
    gyroscopic_effect: float = 1.0  # Scale of the unmodelled gyroscopic coupling; 0 is off.
    initial_charge: float = 1.0  # State of charge at the start of an episode, in [0, 1].
    position_noise: float = 0.0  # Standard deviation of the estimated position, metres.
    yaw_noise: float = 0.0  # Of the estimated yaw, radians.
    velocity_noise: float = 0.0  # Of the estimated velocities, m/s and rad/s.


@dataclass
class WorldConfig:
    """What can go wrong in the ward."""

    wrong_item_probability: float = 0.05  # That a dispenser hands over another item than asked for.
    wrong_items: list[str] = field(default_factory=list)  # Kinds handed over first, whatever is asked, for tests.
    obstacles: list[ObstacleConfig] = field(default_factory=list)  # Not on the map; only the sensor sees them.
    displaced_places: list[DisplacedPlaceConfig] = field(default_factory=list)  # Unknown to planner and controller.
    randomly_displaced: list[str] = field(default_factory=list)  # Places displaced by 1.5 to 4 m, drawn by the seed.
    risk_variation: float = 0.0  # v: an episode's congestion risk is U(1 - v, 1 + v) times the planner's.


@dataclass
class PatientConfig:
    """Who is cared for."""

    profile: str = "speed_oriented"  # One of the five profiles, unless true_weights are given.
    true_weights: list[float] = field(default_factory=list)  # (time, safety, battery, proximity, approach), sum 1.
    noise: float = 0.1  # Standard deviation of a rating.
    clip: bool = False  # Whether ratings are cut to [1, 5].
    missing: float = 0.0  # Probability that a criterion is left unrated.
    earlier_weights: list[float] = field(default_factory=list)  # What the patient wanted before a change of mind.
    earlier_episodes: int = 0  # How many of the first episodes that was for.


@dataclass
class LearnerConfig:
    """How the preferences are learned."""

    name: str = "posterior"  # posterior, projected_gradient (the paper's), reference_gradient, fixed, random, bandit.
    initial_weights: list[float] = field(default_factory=list)  # Of the gradient learners and fixed; uniform if empty.
    learning_rate: float = 0.12  # eta of the gradient learners.
    random_initial_weights: bool = False  # Drawn evenly from the simplex instead, by the seed.
    exploration: float = 0.15  # Of the gradient learners: standard deviation added to the planning weights.
    exploration_decay: float = 0.2  # How fast it falls with the number of episodes; 0 is never.
    exploration_until: float = 0.03  # Of the posterior: the weights' deviation at which it stops; 1 is at once.


@dataclass
class GroundingConfig:
    """How the robot's state becomes symbols."""

    membership: str = "fuzzy"  # fuzzy (degrees of truth), or crisp (an atom is true or false).


@dataclass
class PlannerConfig:
    """How the task planner behaves."""

    max_actions: int = 60  # Actions of one task after which it has failed: K of the paper.
    max_expansions: int = 200_000  # Of one search.
    learned_costs: bool = True  # Whether what actions really cost corrects what the planner predicts.


@dataclass
class ControlConfig:
    """The model predictive controller and the rules of a leg."""

    solver: str = "rti"  # rti, snopt or ipopt: three solvers of one problem.
    sqp_iterations: int = 20  # Of solver rti, at most, per sample; 1 is the real-time iteration.
    horizon: int = 20  # Stages of one control period.
    horizon_kind: str = "receding"  # receding (always as long), or shrinking (to the end of the leg).
    step_budget: int = 400  # Control steps of one leg.
    waypoint_iterations: int = 50  # Control steps to the next waypoint.
    tolerated_failures: int = 5  # Failed solves in a row before the leg has failed.
    learned_targets: bool = False  # Whether targets move to where the mismatch after their legs vanishes.
    target_evidence: str = "fuzzy"  # By which: fuzzy (the missing membership), or geometric (also the place as seen).
    learned_dynamics: bool = False  # Whether the controller's model is corrected by how the robot really drives.

    @property
    def solver_options(self) -> dict[str, Any]:
        """What `MakeSolver` is to be told besides the name."""
        return {"sqp_iterations": self.sqp_iterations} if self.solver == "rti" else {}


@dataclass
class Scenario:
    """One run: who is cared for, in which ward, by which robot, for how many episodes."""

    random_seed: int = 0
    task: str = "medication"  # What every episode is; alternate is medication and meal in turn.
    episodes: int = 2
    episode_time_limit: float = 900.0  # Seconds of simulation after which an episode has failed.
    ward: str = ""  # Path of a ward map, from the scenario's folder; empty is the map that comes with the package.
    robot: RobotConfig = field(default_factory=RobotConfig)
    world: WorldConfig = field(default_factory=WorldConfig)
    patient: PatientConfig = field(default_factory=PatientConfig)
    learner: LearnerConfig = field(default_factory=LearnerConfig)
    grounding: GroundingConfig = field(default_factory=GroundingConfig)
    planner: PlannerConfig = field(default_factory=PlannerConfig)
    control: ControlConfig = field(default_factory=ControlConfig)

    @property
    def true_weights(self) -> tuple[float, ...]:
        """The patient's weights w*: those of the end, should there be a change of mind."""
        return tuple(self.patient.true_weights) or profile_weights(self.patient.profile)

    def true_weights_in(self, episode: int) -> tuple[float, ...]:
        """The patient's weights w* in an episode, counted from 0."""
        early = episode < self.patient.earlier_episodes
        return tuple(self.patient.earlier_weights) if early else self.true_weights

    @property
    def settled_learner(self) -> LearnerConfig:
        """The learner's settings once the seed has drawn what it is to draw."""
        if not self.learner.random_initial_weights:
            return self.learner
        generator = keyed_generator(self.random_seed, 0, "initial_weights")
        drawn = generator.dirichlet(np.ones(len(CRITERIA))).tolist()
        return replace(self.learner, initial_weights=drawn)

    @property
    def profile_name(self) -> str:
        """The profile as results name it."""
        return "custom" if self.patient.true_weights else self.patient.profile

    def load_ward(self) -> Ward:
        """The map of the ward."""
        return LoadWard(self.ward or None)

    def true_ward(self, ward: Ward) -> Ward:
        """The ward of this map as it really is."""
        return displaced_ward(ward, self.displacements(ward))

    def displacements(self, ward: Ward) -> dict[str, Displacement]:
        """By place, how far it is from where this map has it, once the seed has drawn what it is to draw."""
        told = {moved.place: (moved.dx, moved.dy) for moved in self.world.displaced_places}
        generator = keyed_generator(self.random_seed, 0, "displaced_places")
        return draw_displacements(ward, self.world.randomly_displaced, generator, self.unmapped_shapes, told)

    @property
    def unmapped_shapes(self) -> tuple[Shape, ...]:
        """The obstacles that are not on the map, seen from above."""
        return tuple(Shape(o.name, o.x, o.y, o.yaw, o.half_length, o.half_width) for o in self.world.obstacles)


def LoadScenario(path: str | Path | None = None, *, defaults: Scenario | None = None) -> Scenario:
    """Reads and validates a scenario; fields that are missing have their defaults.

    Args:
        path: a Drake YAML file; None is the default scenario that comes with the package.
        defaults: of the fields that are missing, if they are to be others than those of this module.

    Raises:
        BadInput: naming file, field, value and what was expected.
    """
    file = Path(path) if path is not None else models_folder() / "default.scenario.yaml"
    scenario = load_typed(Scenario, file, defaults=Scenario() if defaults is None else defaults)
    if scenario.ward:
        scenario.ward = str(file.parent / scenario.ward)
    Validate(scenario, where=file.name)
    return scenario


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
    _one_of(at + "control.horizon_kind", scenario.control.horizon_kind, HORIZON_KINDS)
    _one_of(at + "control.target_evidence", scenario.control.target_evidence, TARGET_EVIDENCE)


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
        ("control.sqp_iterations", control.sqp_iterations, 1, 1_000),
        ("control.step_budget", control.step_budget, 1, 100_000),
        ("control.waypoint_iterations", control.waypoint_iterations, 1, 100_000),
        ("control.tolerated_failures", control.tolerated_failures, 0, 1_000),
    )
    for name, value, low, high in ranges:
        if not low <= value <= high:
            limits = f"a number >= {low:g}" if math.isinf(high) else f"a number from {low:g} to {high:.10g}"
            raise BadInput(at + name, f"{value:.10g}", limits)


def _checked_ward(scenario: Scenario, at: str) -> Ward:
    """The ward, once it is known that there is a home and that the robot fits wherever it is to stand."""
    if scenario.ward and not Path(scenario.ward).is_file():
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
    home = next(place for place in ward.places if place.category == "home")
    names = [obstacle.name for obstacle in scenario.world.obstacles]
    for i, (config, shape) in enumerate(zip(scenario.world.obstacles, scenario.unmapped_shapes, strict=True)):
        where = f"{at}world.obstacles[{i}]"
        if not config.name or config.name in names[:i]:
            raise BadInput(f"{where}.name", repr(config.name), "a name that no other obstacle has")
        if min(config.half_length, config.half_width, config.height) <= 0:
            raise BadInput(where, "a size that is not positive", "half_length, half_width and height above 0")
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
