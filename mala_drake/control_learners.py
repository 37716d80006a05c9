"""The learners that tell the controller something, as a scenario wants them (paper, Sec. "Updating the MPC ...")."""

from __future__ import annotations

from pydrake.systems.framework import LeafSystem

from mala_drake.control import OptimalControlProblem
from mala_drake.control.leg import LegGuide
from mala_drake.control.sensitivities.cost_sensitivity import CostSensitivity
from mala_drake.control.sensitivities.leg_cost import LegCost
from mala_drake.control.sensitivities.leg_simulator import LegSimulator
from mala_drake.control.sensitivities.target_sensitivity import TargetSensitivity
from mala_drake.control.solver_by_horizon import solver_of_kind
from mala_drake.learning.dynamics_estimator import DynamicsEstimator
from mala_drake.learning.dynamics_learner import DynamicsLearner
from mala_drake.learning.target_estimator import TargetEstimator
from mala_drake.learning.target_learner import TargetLearner
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.learning.weight_learner import WeightLearner
from mala_drake.robot.drive_charge import charge_rate
from mala_drake.scenario import ControlConfig, Scenario
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.features import bed_shape
from mala_drake.ward.ward_map import Ward


def make_control_learners(
    scenario: Scenario, ward: Ward, guide: LegGuide, congestion: Congestion
) -> dict[str, LeafSystem]:
    """The systems by their names in the station; none by default.

    Each has one output port, named as the controller's input. Who simulates legs has a solver of its own, since the
    controller's is in use.

    Args:
        scenario: valid.
        ward: as the robot's map has it.
        guide: of the controller.
        congestion: of the ward.
    """
    control = scenario.control
    learners: dict[str, LeafSystem] = {}
    if control.learned_targets:
        learners["target_learner"] = _target_learner(control, ward, guide, congestion)
    if control.learned_dynamics:
        learners["dynamics_learner"] = DynamicsLearner(learner=dynamics_estimator(scenario))
    if control.learned_weights or control.learned_translation:
        learners["weight_learner"] = _weight_learner(control, ward, guide, congestion)
    return learners


def dynamics_estimator(scenario: Scenario) -> DynamicsEstimator:
    """What estimates the coefficients of the controller's model."""
    robot = scenario.robot
    return DynamicsEstimator(pose_noise=max(robot.position_noise, robot.yaw_noise), velocity_noise=robot.velocity_noise)


def _target_learner(control: ControlConfig, ward: Ward, guide: LegGuide, congestion: Congestion) -> TargetLearner:
    simulated = control.target_sensitivity == "simulated"
    return TargetLearner(
        learner=TargetEstimator({place.name: (place.x, place.y) for place in ward.places}),
        yaws={place.name: place.yaw for place in ward.places},
        sensitivity=TargetSensitivity(_simulator(control, guide, congestion)) if simulated else None,
        mapped=ward.shapes,
        geometric=control.target_evidence == "geometric",
    )


def _weight_learner(control: ControlConfig, ward: Ward, guide: LegGuide, congestion: Congestion) -> WeightLearner:
    return WeightLearner(
        weights=WeightEstimator([place.name for place in ward.places]) if control.learned_weights else None,
        translation=TranslationEstimator(rate=control.translation_rate) if control.learned_translation else None,
        targets={place.name: (place.x, place.y, place.yaw) for place in ward.places},
        gradient=CostSensitivity(
            _simulator(control, guide, congestion),
            cost=LegCost(bed=bed_shape(ward), charge_rate=charge_rate),
            bedsides=[place.name for place in ward.places if place.category == "bedside"],
        ),
    )


def _simulator(control: ControlConfig, guide: LegGuide, congestion: Congestion) -> LegSimulator:
    problem = OptimalControlProblem(horizon=control.horizon)
    solver, shortest = solver_of_kind(control.horizon_kind, control.solver, problem, **control.solver_options)
    return LegSimulator(problem, solver, guide, congestion, shortest_horizon=shortest)
