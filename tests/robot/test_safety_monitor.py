"""The safety monitor alone, and on a robot that runs into things."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from pydrake.common.value import Value
from pydrake.geometry import Box
from pydrake.math import RigidTransform
from pydrake.multibody.plant import ContactResults, CoulombFriction
from pydrake.systems.analysis import Simulator

from mala_drake.clock import PLANT_STEP
from mala_drake.messages import Shape
from mala_drake.robot import safety_monitor as mut
from mala_drake.robot.plant import SetRobotPose
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, QW, X, Y
from mala_drake.robot.robot_parameters import NOMINAL
from mala_drake.ward.shapes import outline

CRATE = Shape("crate", x=2.5, y=0.0, half_length=0.5, half_width=0.5)


def _state_at(x, y):
    state = np.zeros(PLANT_STATE_SIZE)
    state[[QW, X, Y]] = 1.0, x, y
    return state


def test_drawn_ports_are_the_real_ports(make_bench, assert_port_box):
    assert_port_box(mut.SafetyMonitor(make_bench().robot, [CRATE]))


def test_the_smallest_clearance_is_that_of_all_steps(make_bench):
    """A random walk among shapes of all kinds, against shapely's distances at every single step."""
    generator = np.random.default_rng(4)
    shapes = [
        Shape("box", 1.0, 0.5, 0.4, 0.5, 0.2, 0.0),
        Shape("disc", -1.2, 0.3, 0.0, 0.0, 0.0, 0.4),
        Shape("rounded", 0.2, -1.5, -0.7, 0.6, 0.3, 0.1),
    ]
    dut = mut.SafetyMonitor(make_bench().robot, shapes)
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("contact_results").FixValue(context, Value(ContactResults()))
    position = np.zeros(2)
    plant_state = dut.GetInputPort("plant_state").FixValue(context, _state_at(*position))
    smallest, heading = math.inf, 0.0
    # Shapely rounds corners by chords from outside; with the exact core and the radius apart it is exact.
    cores = [(outline(Shape(s.name, s.x, s.y, s.yaw, s.half_length, s.half_width, 0.0)), s.radius) for s in shapes]
    for step in range(1500):
        plant_state.GetMutableData().get_mutable_value().SetFromVector(_state_at(*position))
        simulator.AdvanceTo((step + 0.5) * PLANT_STEP)
        point = shapely.Point(position)
        clearances = [core.distance(point) - radius for core, radius in cores]
        smallest = min(smallest, min(clearances) - NOMINAL.body_radius)
        assert dut.GetOutputPort("safety").Eval(context)[0] == pytest.approx(smallest, abs=1e-9)
        heading += 0.3 * generator.standard_normal()
        position = np.clip(position + 0.015 * np.array([math.cos(heading), math.sin(heading)]), -0.4, 0.4)
    assert smallest < 0.0


def test_with_nothing_solid_the_clearance_is_infinite(make_bench):
    dut = mut.SafetyMonitor(make_bench().robot, [])
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("contact_results").FixValue(context, Value(ContactResults()))
    dut.GetInputPort("plant_state").FixValue(context, _state_at(0.0, 0.0))
    simulator.AdvanceTo(0.1)
    assert dut.GetOutputPort("safety").Eval(context).tolist() == [math.inf, 0.0, 0.0]


@pytest.fixture
def make_watched_bench(make_bench):
    """A robot with a crate two metres ahead, one beside it, and a monitor."""

    def make():
        monitors = []

        def add(plant, scene_graph, robot):
            friction = CoulombFriction(0.5, 0.5)
            X_WC = RigidTransform([CRATE.x, CRATE.y, 0.5])
            plant.RegisterCollisionGeometry(plant.world_body(), X_WC, Box(1, 1, 1), "crate", friction)

        def wire(builder, plant, robot, drivetrain):
            monitor = builder.AddNamedSystem("monitor", mut.SafetyMonitor(robot, [CRATE]))
            builder.Connect(plant.get_state_output_port(robot.robot), monitor.GetInputPort("plant_state"))
            builder.Connect(plant.get_contact_results_output_port(), monitor.GetInputPort("contact_results"))
            monitors.append(monitor)

        bench = make_bench(add=add, wire=wire)
        (monitor,) = monitors
        context = monitor.GetMyContextFromRoot(bench.context)
        return bench, lambda: monitor.GetOutputPort("safety").Eval(context).tolist()

    return make


def test_a_near_miss_is_no_collision(make_watched_bench):
    bench, safety = make_watched_bench()
    SetRobotPose(bench.plant, bench.plant_context, bench.robot, x=0.0, y=0.81, yaw=0.0)
    bench.drive(2.0, 0.0, 0.0, seconds=0.77)
    bench.drive(0.0, 0.0, 0.0, seconds=2.5)
    assert bench.state()[0] > 3.5
    assert safety() == pytest.approx([0.03, 0.0, 0.0], abs=2e-3)


def test_a_crash_is_counted_once_and_another_one_again(make_watched_bench):
    bench, safety = make_watched_bench()
    bench.drive(2.0, 0.0, 0.0, seconds=0.77)
    bench.drive(0.0, 0.0, 0.0, seconds=1.5)
    bench.drive(0.5, 0.0, 0.0, seconds=1.0)
    clearance, collisions, touching = safety()
    assert clearance < 0.0
    assert (collisions, touching) == (1.0, 1.0)
    bench.drive(-0.5, 0.0, 0.0, seconds=1.5)
    assert safety()[1:] == [1.0, 0.0]
    bench.drive(1.0, 0.0, 0.0, seconds=2.5)
    assert safety()[1] == 2.0
