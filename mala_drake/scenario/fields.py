"""What to simulate: plain fields, each with a default. `file` reads them, `validation` checks them.

Drake's YAML reader looks at the fields' types themselves, so annotations in this module are not postponed.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mala_drake.messages import Shape
from mala_drake.patient.profiles import profile_weights
from mala_drake.preferences import CRITERIA
from mala_drake.randomness import keyed_generator
from mala_drake.ward.displacement import Displacement, displaced_ward, draw_displacements
from mala_drake.ward.ward_map import LoadWard, Ward

HORIZON_KINDS = ("receding", "shrinking")
TARGET_EVIDENCE = ("fuzzy", "geometric")
TARGET_SENSITIVITIES = ("simulated", "identity")


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
    qp_solver: str = "daqp"  # Of solver rti, for its quadratic programs: daqp, clarabel or osqp.
    tolerance: float = 1e-4  # On first-order optimality, of any solver.
    hard_clearance: bool = (
        False  # Whether the clearance is also a constraint, where it can be kept, or a penalty alone.
    )
    horizon: int = 20  # Stages of one control period.
    horizon_kind: str = "receding"  # receding (always as long), or shrinking (to the end of the leg).
    step_budget: int = 400  # Control steps of one leg.
    waypoint_iterations: int = 50  # Control steps to the next waypoint.
    tolerated_failures: int = 5  # Failed solves in a row before the leg has failed.
    learned_targets: bool = False  # Whether targets move to where the mismatch after their legs vanishes.
    target_evidence: str = "fuzzy"  # By what: fuzzy (missing memberships), or geometric (also the place as seen).
    target_sensitivity: str = "simulated"  # Of a leg's end by its target: simulated (in closed loop), or identity.
    learned_dynamics: bool = False  # Whether the controller's model is corrected by how the robot really drives.
    learned_weights: bool = False  # Whether its weights move, by target, so that legs come to cost what was predicted.
    learned_translation: bool = False  # Whether how preferences become its weights moves likewise.
    translation_rate: float = 0.002  # Of the latter: the share of a Gauss-Newton step that one leg makes.

    @property
    def solver_options(self) -> dict[str, Any]:
        """What `MakeSolver` is to be told besides the name."""
        own = {"sqp_iterations": self.sqp_iterations, "qp_solver": self.qp_solver} if self.solver == "rti" else {}
        return {"tolerance": self.tolerance, "hard_clearance": self.hard_clearance, **own}


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
