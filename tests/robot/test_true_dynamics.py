"""The true coefficients, against how a robot in the plant really answers its controls.

Casters drag, by one or two parts in a hundred of a command, of which masses and inertias do not tell. It is much the
same for every robot, so that gains are compared with those of the nominal one.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.tree import SpatialInertia

from mala_drake.clock import PLANT_STEP
from mala_drake.errors import BadInput
from mala_drake.robot import true_dynamics as mut
from mala_drake.robot.arm_kinematics import PAD_OFFSETS
from mala_drake.robot.gyroscopic_effect import GyroscopicEffect
from mala_drake.robot.items import ITEM_MASS

V_X, V_Y, OMEGA = 3, 4, 5
SIDE = 0.01  # Of a box that is as good as a point, metres.


@pytest.fixture
def make_robot(make_bench):
    """A bench with a robot whose errors, gyroscopic effect and load are as told."""

    def make(hidden_truth, gyroscopic_effect, boxes):
        def wire(builder, plant, robot, drivetrain):
            effect = builder.AddSystem(GyroscopicEffect(plant, robot, scale=gyroscopic_effect))
            builder.Connect(plant.get_state_output_port(robot.robot), effect.GetInputPort("plant_state"))
            builder.Connect(effect.get_output_port(), plant.get_applied_generalized_force_input_port())

        def load(plant, scene_graph, robot):
            for i, offset in enumerate(PAD_OFFSETS[:boxes]):
                inertia = SpatialInertia.SolidBoxWithMass(ITEM_MASS, SIDE, SIDE, SIDE)
                box = plant.AddRigidBody(f"box_{i}", robot.arm, inertia)
                plant.WeldFrames(robot.gripper, box.body_frame(), RigidTransform([0.0, offset, 0.0]))

        bench = make_bench(hidden_truth=hidden_truth, add=load, wire=wire)
        bench.drive(0.0, 2.0, 0.0, seconds=0.5 * PLANT_STEP)  # From now on always between two steps.
        return bench

    return make


def mean_slope(bench, index, control, *, settle, seconds):
    """The mean rate of change of a velocity while a control is held, once the robot has stopped rocking."""
    bench.drive(*control, seconds=settle)
    before = bench.state()[index]
    bench.drive(*control, seconds=seconds)
    return (bench.state()[index] - before) / seconds


def pushed_and_braked(bench):
    pushed = mean_slope(bench, V_X, (1.5, 0.0, 0.0), settle=0.4, seconds=0.4)
    # A little propulsion keeps the brake from being the parking brake.
    return pushed, mean_slope(bench, V_X, (1e-9, 1.5, 0.0), settle=0.3, seconds=0.2)


def turned(bench):
    return mean_slope(bench, OMEGA, (0.0, 0.0, 0.8), settle=0.4, seconds=0.4)


def coast_in_a_curve(bench):
    """Without a command omega' = -c v omega, so that log omega falls by c a metre; c and the slip at the end."""
    for control in ((2.0, 0.0, 0.0), (0.0, 0.0, 0.8)):
        bench.drive(*control, seconds=0.8)
    bench.drive(0.0, 0.0, 0.0, seconds=0.4)
    before, seconds = bench.state(), 1.0
    bench.drive(0.0, 0.0, 0.0, seconds=seconds)
    after = bench.state()
    metres = 0.5 * (before[V_X] + after[V_X]) * seconds
    return math.log(before[OMEGA] / after[OMEGA]) / metres, after[V_Y] / (after[V_X] * after[OMEGA])


ROBOTS = [(1.0, 0.0, 0), (2.0, 1.0, 0), (1.0, 1.0, 2)]


@pytest.mark.parametrize("robot", ROBOTS)
def test_gains_are_what_a_command_comes_to(make_robot, robot):
    truth, nominal = (mut.true_dynamics(hidden_truth=h, gyroscopic_effect=g, boxes=n) for h, g, n in (robot, (0, 0, 0)))
    for measure, names in ((pushed_and_braked, ("propulsion_gain", "brake_gain")), (turned, ("yaw_gain",))):
        measured, expected = (np.atleast_1d(measure(make_robot(*each))) for each in (robot, (0.0, 0.0, 0)))
        ratios = [getattr(truth, name) / getattr(nominal, name) for name in names]
        assert measured / expected == pytest.approx(ratios, rel=0.015)


@pytest.mark.parametrize("robot", [(0.0, 0.0, 0), *ROBOTS])
def test_coasting_in_a_curve_shows_coupling_and_slip(make_robot, robot):
    hidden_truth, gyroscopic_effect, boxes = robot
    truth = mut.true_dynamics(hidden_truth=hidden_truth, gyroscopic_effect=gyroscopic_effect, boxes=boxes)
    coupling, slip = coast_in_a_curve(make_robot(*robot))
    assert coupling == pytest.approx(truth.yaw_coupling, rel=0.1)
    assert slip == pytest.approx(truth.lateral_slip, rel=0.05)


def test_the_nominal_robot_is_what_the_model_takes_it_for():
    nominal = mut.true_dynamics(hidden_truth=0.0, gyroscopic_effect=0.0)
    gains = nominal.propulsion_gain, nominal.brake_gain, nominal.yaw_gain
    assert gains == pytest.approx((1.0, 1.0, 1.0), abs=0.002)


def test_refuses_a_robot_that_is_none():
    with pytest.raises(BadInput, match="hidden_truth"):
        mut.true_dynamics(hidden_truth=math.inf, gyroscopic_effect=1.0)
