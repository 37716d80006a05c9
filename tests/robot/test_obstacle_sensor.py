import math

import pytest
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector

import mala_drake.robot.obstacle_sensor as mut
from mala_drake.errors import BadInput
from mala_drake.messages import Obstacles, Shape

DESK = Shape("desk", 3.0, 0.0, 0.0, 0.5, 0.5)
WALL = Shape("wall", 0.0, 4.0, 0.0, 5.0, 0.1)
TROLLEY = Shape("trolley", 0.0, 6.0, 0.0, 0.6, 0.35)


@pytest.fixture
def look():
    sensor = mut.ObstacleSensor(mapped=[DESK, WALL], unmapped=[TROLLEY])
    context = sensor.CreateDefaultContext()

    def look(x, y, yaw=0.0):
        sensor.GetInputPort("robot_state").FixValue(context, BasicVector([x, y, yaw, 0.0, 0.0, 0.0]))
        return sensor.GetOutputPort("obstacles").Eval(context)

    return look


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(mut.ObstacleSensor(mapped=[DESK]))


def test_mapped_shapes_in_sight_are_told_as_they_are(look):
    assert look(0.0, 0.0) == Obstacles((DESK, WALL))


def test_what_is_not_on_the_map_is_seen_only_from_where_nothing_hides_it(look):
    assert TROLLEY not in look(0.0, 2.0).shapes
    assert TROLLEY in look(0.0, 8.0).shapes


def test_far_away_nothing_is_seen(look):
    assert look(30.0, 30.0) == Obstacles()


def test_the_same_sight_is_the_same_object(look):
    here, elsewhere, again = look(0.0, 0.0), look(0.0, 8.0), look(0.1, 0.0, 1.0)
    assert again is here
    assert elsewhere is not here


@pytest.mark.parametrize("x", [math.nan, math.inf])
def test_without_a_position_nothing_is_seen(look, x):
    assert look(x, 0.0) == Obstacles()


def test_a_shorter_reach_sees_less():
    sensor = mut.ObstacleSensor(mapped=[DESK, WALL], reach=3.0)
    context = sensor.CreateDefaultContext()
    sensor.GetInputPort("robot_state").FixValue(context, [0.0] * 6)
    assert sensor.GetOutputPort("obstacles").Eval(context) == Obstacles((DESK,))


@pytest.mark.parametrize("reach", [0.0, -1.0, math.nan, math.inf])
def test_a_reach_that_is_none_is_refused(reach):
    with pytest.raises(BadInput, match="obstacle sensor reach"):
        mut.ObstacleSensor(mapped=[], reach=reach)


def test_the_port_takes_messages_only():
    sensor = mut.ObstacleSensor(mapped=[])
    assert isinstance(sensor.GetOutputPort("obstacles").Allocate(), type(Value(Obstacles())))
