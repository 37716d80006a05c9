"""The care station: every layer as a system, wired around the robot's physics. Reads like the figure in the README."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder

from mala_drake.control import OptimalControlProblem
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.mpc_controller import MpcController
from mala_drake.control.solver_by_horizon import solver_of_kind
from mala_drake.control_learners import make_control_learners
from mala_drake.errors import BadInput
from mala_drake.grounding.atom_memberships import location_membership, predicate_memberships
from mala_drake.grounding.fuzzy_grounding import FuzzyGrounding
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.learning.cost_learner import CostLearner
from mala_drake.learning.make_learner import make_learner
from mala_drake.learning.preference_learner import PreferenceLearner
from mala_drake.patient.patient import Patient
from mala_drake.planning.task_planner import TaskPlanner
from mala_drake.robot.action_meter import ActionMeter
from mala_drake.robot.arm import Arm
from mala_drake.robot.battery import Battery
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.feature_meter import FeatureMeter
from mala_drake.robot.gyroscopic_effect import GyroscopicEffect
from mala_drake.robot.in_place_executor import InPlaceExecutor
from mala_drake.robot.item_positions import ItemPositions
from mala_drake.robot.items import AddItems, ItemBodies
from mala_drake.robot.magnet import Magnet
from mala_drake.robot.obstacle import AddObstacle
from mala_drake.robot.obstacle_sensor import ObstacleSensor
from mala_drake.robot.plant import AddCareRobot, CareRobot, MakeCarePlant, X_WB_at
from mala_drake.robot.safety_monitor import SafetyMonitor
from mala_drake.robot.state_estimator import StateEstimator
from mala_drake.robot.ward_plant import AddWard
from mala_drake.robot.world import World
from mala_drake.scenario import Scenario, Validate
from mala_drake.scheduling.scheduler import Scheduler
from mala_drake.scheduling.sequence import task_names
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.items import all_items
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.ward_map import Ward
from mala_drake.wiring import Wiring

_FRAME_RATE = 20.0  # Pictures per second in Meshcat.


def MakeCareStation(scenario: Scenario, *, meshcat: Meshcat | None = None, task: str | None = None) -> Diagram:
    """The whole stack for one scenario, as a Drake diagram like any other.

    A default context starts at the first episode, with the robot at home. The subsystems have the names of their
    classes in snake_case, the plant is `plant`.

    Args:
        scenario: what to simulate; validated here.
        meshcat: shows it, if given.
        task: has only the boxes in the ward that an episode with this task needs; None for those that any episode of
            the scenario needs. Every box costs time at each step of the plant.

    Raises:
        BadInput: naming the field of the scenario, or the place in a model, that is wrong.
    """
    Validate(scenario)
    ward = scenario.load_ward()
    names = task_names(scenario.task, episodes=scenario.episodes)
    if task is not None and task not in names:
        raise BadInput("task", repr(task), "one of " + ", ".join(sorted(set(names))))
    station = _StationBuilder(scenario, ward, meshcat, names, frozenset(names if task is None else (task,)))
    station.add_physics()
    station.add_low_level()
    station.add_layers()
    station.add_learning()
    station.connect()
    return station.build()


class _StationBuilder:
    """Adds the systems layer by layer, from the floor up, then wires them."""

    def __init__(
        self, scenario: Scenario, ward: Ward, meshcat: Meshcat | None, names: Sequence[str], tasks: frozenset[str]
    ) -> None:
        self._scenario = scenario
        self._ward = ward  # As the robot's map has it.
        self._true_ward = scenario.true_ward(ward)
        self._meshcat = meshcat
        self._congestion = Congestion(ward)
        self._names = names
        self._kept = all_items(self._true_ward, tasks)
        self._builder = DiagramBuilder()
        self._plant: MultibodyPlant
        self._robot: CareRobot
        self._items: ItemBodies

    def _add(self, name: str, system: Any) -> Any:
        return self._builder.AddNamedSystem(name, system)

    def add_physics(self) -> None:
        """Ward, robot, boxes and what stands about, in one discrete plant with contact."""
        self._plant, self._scene_graph = MakeCarePlant(self._builder)
        visible = self._meshcat is not None
        AddWard(self._plant, self._true_ward, visible=visible)
        self._robot = AddCareRobot(
            self._plant, self._scene_graph, hidden_truth=self._scenario.robot.hidden_truth, visible=visible
        )
        self._items = AddItems(self._plant, self._scene_graph, self._kept, self._robot, visible=visible)
        for shape, config in zip(self._scenario.unmapped_shapes, self._scenario.world.obstacles, strict=True):
            AddObstacle(self._plant, shape, height=config.height)
        home = next(place for place in self._ward.places if place.category == "home")
        self._plant.SetDefaultFloatingBaseBodyPose(self._robot.base, X_WB_at(home.x, home.y, home.yaw))
        self._plant.Finalize()

    def add_low_level(self) -> None:
        """What belongs to the robot's body: drivetrain, arm, magnet, battery, sensors; and what it does not know."""
        config = self._scenario.robot
        noise = (config.position_noise,) * 2 + (config.yaw_noise,) + (config.velocity_noise,) * 3
        seed = self._scenario.random_seed
        self._drivetrain = self._add("drivetrain", Drivetrain())
        self._arm = self._add("arm", Arm())
        self._magnet = self._add("magnet", Magnet(self._plant, self._robot, self._items))
        self._gyroscopic_effect = self._add(
            "gyroscopic_effect", GyroscopicEffect(self._plant, self._robot, scale=config.gyroscopic_effect)
        )
        self._forces = self._add("forces", Adder(2, self._plant.num_velocities()))
        self._battery = self._add("battery", Battery(initial_charge=config.initial_charge))
        self._state_estimator = self._add("state_estimator", StateEstimator(noise=noise, seed=seed))
        self._item_positions = self._add("item_positions", ItemPositions(self._plant, self._items))
        unmapped = self._scenario.unmapped_shapes
        self._obstacle_sensor = self._add(
            "obstacle_sensor", ObstacleSensor(mapped=self._true_ward.shapes, unmapped=unmapped)
        )
        self._safety_monitor = self._add(
            "safety_monitor",
            SafetyMonitor(
                self._robot,
                (*self._true_ward.shapes, *unmapped),
                ignored=[body.index() for body in self._items.bodies],
            ),
        )

    def add_layers(self) -> None:
        """Scheduler, planner, grounding, control, and the world that answers."""
        scenario, ward = self._scenario, self._ward
        places = {place.name: (place.x, place.y, place.yaw) for place in ward.places}
        self._scheduler = self._add("scheduler", Scheduler(tasks=self._names))
        self._task_planner = self._add(
            "task_planner",
            TaskPlanner(
                ward,
                tasks=sorted(set(self._names)),
                max_actions=scenario.planner.max_actions,
                max_expansions=scenario.planner.max_expansions,
            ),
        )
        self._grounding = self._add(
            "fuzzy_grounding",
            FuzzyGrounding(
                locations={place.name: (place.x, place.y) for place in self._true_ward.places},
                location_membership=location_membership(scenario.grounding.membership),
                predicate_memberships=predicate_memberships(scenario.grounding.membership),
            ),
        )
        rules = LegRules(
            step_budget=scenario.control.step_budget,
            waypoint_iterations=scenario.control.waypoint_iterations,
            tolerated_failures=scenario.control.tolerated_failures,
        )
        control = scenario.control
        problem = OptimalControlProblem(horizon=control.horizon)
        solver, shortest = solver_of_kind(control.horizon_kind, control.solver, problem, **control.solver_options)
        self._guide = LegGuide(leg_planner(ward), self._congestion, ward.shapes, rules)
        self._controller = self._add(
            "mpc_controller",
            MpcController(
                targets=places,
                guide=self._guide,
                congestion=self._congestion,
                problem=problem,
                solver=solver,
                shortest_horizon=shortest,
            ),
        )
        self._executor = self._add("in_place_executor", InPlaceExecutor(self._true_ward, items=self._kept))
        self._world = self._add(
            "world",
            World(
                self._true_ward,
                items=self._kept,
                wrong_item_probability=scenario.world.wrong_item_probability,
                wrong_items=scenario.world.wrong_items,
                seed=scenario.random_seed,
            ),
        )
        self._feature_meter = self._add(
            "feature_meter",
            FeatureMeter(ward, risk_variation=scenario.world.risk_variation, seed=scenario.random_seed),
        )
        bedsides = [place.name for place in ward.places if place.category == "bedside"]
        self._action_meter = self._add("action_meter", ActionMeter(bedsides=bedsides))

    def add_learning(self) -> None:
        """The patient, and who learns: from ratings, what actions cost, and what the controller is to know."""
        scenario = self._scenario
        self._patient = self._add(
            "patient",
            Patient(
                profile_weights=scenario.true_weights,
                profile=scenario.profile_name,
                noise=scenario.patient.noise,
                clip=scenario.patient.clip,
                missing=scenario.patient.missing,
                earlier_weights=scenario.patient.earlier_weights,
                earlier_episodes=scenario.patient.earlier_episodes,
                seed=scenario.random_seed,
            ),
        )
        self._learner = self._add(
            "preference_learner",
            PreferenceLearner(learner=make_learner(scenario.settled_learner), seed=scenario.random_seed),
        )
        self._cost_learner = None
        if scenario.planner.learned_costs:
            estimator = CostEstimator(self._task_planner.predictions)
            self._cost_learner = self._add("cost_learner", CostLearner(learner=estimator))
        learners = make_control_learners(scenario, self._ward, self._guide, self._congestion)
        self._control_learners = [self._add(name, learner) for name, learner in learners.items()]

    def connect(self) -> None:
        """Wires everything, source by source."""
        plant, robot, wiring = self._plant, self._robot, Wiring(self._builder)
        # What each layer tells the others.
        wiring.wire(self._scheduler, "task", self._task_planner, self._world, self._feature_meter, self._action_meter)
        wiring.wire(
            self._task_planner,
            "action",
            self._controller,
            self._executor,
            self._world,
            self._grounding,
            self._feature_meter,
            self._action_meter,
        )
        wiring.wire(self._task_planner, "task_report", self._scheduler, self._feature_meter, self._action_meter)
        wiring.wire(self._controller, "leg_report", self._task_planner, self._action_meter)
        wiring.wire(
            self._executor, "in_place_report", self._task_planner, self._world, self._grounding, self._action_meter
        )
        wiring.wire(self._executor, "magnet", self._magnet, self._world, self._controller)
        wiring.wire(self._executor, "arm_target", self._arm)
        wiring.wire(self._executor, "charge_rates", self._battery)
        wiring.wire(self._world, "world_facts", self._grounding)
        wiring.wire(self._world, "handed_item", self._executor)
        wiring.wire(self._world, "clamped", self._magnet)
        wiring.wire(self._grounding, "symbolic_state", self._task_planner)
        wiring.wire(self._grounding, "place_mismatch", self._action_meter)
        wiring.wire(self._obstacle_sensor, "obstacles", self._controller)
        wiring.wire(self._feature_meter, "episode_report", self._patient)
        wiring.wire(self._feature_meter, "action_features", self._action_meter)
        wiring.wire(self._patient, "ratings", self._learner)
        wiring.wire(self._learner, "preferences", self._task_planner, self._controller, self._action_meter)
        for learner in self._control_learners:
            wiring.listen(learner, self._task_planner, self._controller, self._executor, self._grounding)
            wiring.listen(learner, self._obstacle_sensor, self._action_meter, self._learner, *self._control_learners)
        wiring.listen(self._controller, *self._control_learners)
        # What everybody senses.
        wiring.fan_out("plant_state", plant.get_state_output_port(robot.robot))
        wiring.fan_out("arm_state", plant.get_state_output_port(robot.arm))
        if self._cost_learner is not None:
            wiring.wire(self._feature_meter, "action_features", self._cost_learner)
            wiring.wire(self._cost_learner, "learned_costs", self._task_planner)
        wiring.fan_out("robot_state", self._state_estimator.GetOutputPort("robot_state"))
        wiring.fan_out("control", self._controller.GetOutputPort("control"))
        wiring.fan_out("charge", self._battery.GetOutputPort("charge"))
        wiring.fan_out("item_positions", self._item_positions.GetOutputPort("item_positions"))
        # The robot's body.
        connect = self._builder.Connect
        connect(plant.get_state_output_port(), self._magnet.GetInputPort("state"))
        connect(plant.get_state_output_port(), self._item_positions.GetInputPort("state"))
        connect(plant.get_contact_results_output_port(), self._safety_monitor.GetInputPort("contact_results"))
        connect(self._drivetrain.GetOutputPort("wheel_torques"), plant.get_actuation_input_port(robot.robot))
        connect(self._arm.GetOutputPort("desired_state"), plant.get_desired_state_input_port(robot.arm))
        connect(self._magnet.GetOutputPort("generalized_force"), self._forces.get_input_port(0))
        connect(self._gyroscopic_effect.GetOutputPort("generalized_force"), self._forces.get_input_port(1))
        connect(self._forces.get_output_port(), plant.get_applied_generalized_force_input_port())
        connect(self._drivetrain.GetOutputPort("power"), self._battery.GetInputPort("power"))

    def build(self) -> Diagram:
        """The finished diagram, shown in Meshcat if there is one."""
        if self._meshcat is not None:
            parameters = MeshcatVisualizerParams(role=Role.kIllustration, publish_period=1.0 / _FRAME_RATE)
            MeshcatVisualizer.AddToBuilder(self._builder, self._scene_graph, self._meshcat, parameters)
        diagram = self._builder.Build()
        diagram.set_name("care_station")
        return diagram
