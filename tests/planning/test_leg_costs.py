import math
from pathlib import Path

import numpy as np
import pytest

import mala_drake.planning.leg_costs as mut
from mala_drake.ward.congestion import CRUISE_SPEED, RISK_LENGTH, Congestion
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.features import FeatureRates
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.ward_map import LoadWard, Ward


@pytest.fixture(scope="module")
def costs(ward: Ward) -> mut.LegCosts:
    return mut.LegCosts(ward)


def zone_level(ward: Ward, x: float, y: float) -> float:
    """The highest level at a point; the zones of this ward are rectangles along the axes."""
    level = ward.background_congestion
    for zone in ward.zones:
        xs, ys = zip(*zone.polygon, strict=True)
        if min(xs) < x < max(xs) and min(ys) < y < max(ys):
            level = max(level, zone.level)
    return level


def test_a_leg_takes_at_least_its_length_at_the_speed_limit_and_not_much_more(ward: Ward, costs: mut.LegCosts) -> None:
    for start, goal in (("home", "pharmacy_north"), ("supply_A", "patient_bed_right"), ("supply_B", "charge_main")):
        leg = costs.between(start, goal)
        assert leg is not None
        assert leg.time > leg.length / CRUISE_SPEED
        # Starting, stopping, turning on the spot and slower zones cost seconds, not minutes.
        assert leg.time < leg.length / CRUISE_SPEED * (1 + 0.8) + 15.0


def test_risk_is_the_integral_of_the_level_over_the_route(ward: Ward, costs: mut.LegCosts) -> None:
    leg = costs.between("home", "patient_bed_left")
    route = leg_planner(ward).between("home", "patient_bed_left")
    assert leg is not None
    assert route is not None
    total = 0.0
    for a, b in zip(route.points[:-1], route.points[1:], strict=True):
        length = math.dist(a, b)
        count = math.ceil(length / 0.01)
        for i in range(count):
            x, y = a + (i + 0.5) / count * (b - a)
            total += zone_level(ward, x, y) * length / count
    assert leg.risk == pytest.approx(total / RISK_LENGTH, rel=0.02)


def test_charge_is_lost_to_metres_to_speed_and_to_turns(ward: Ward) -> None:
    nothing = {"charge_per_metre": 0.0, "charge_per_metre_and_speed": 0.0, "charge_per_radian": 0.0}

    def charge(start: tuple[float, float, float] = (0.0, 0.0, 0.0), **constant: float) -> float:
        leg = mut.LegCosts(ward, calibration=mut.LegCalibration(**nothing | constant)).from_pose(start, "supply_B")
        assert leg is not None
        return leg.charge

    route = leg_planner(ward).between("home", "supply_B")
    assert route is not None
    path = make_drive_path(route, Congestion(ward))
    seconds = np.linspace(0.0, path.duration, 20001)
    speeds = np.interp(seconds, path.times, path.speeds)
    assert charge(charge_per_metre=0.01) == pytest.approx(0.01 * path.length)
    by_hand = 0.01 * float(np.trapezoid(speeds**2, seconds))  # A metre is a second times the speed.
    assert charge(charge_per_metre_and_speed=0.01) == pytest.approx(by_hand, rel=1e-3)
    heading = float(path.headings[0])
    straight, turned = (
        charge((0.0, 0.0, heading), charge_per_radian=0.01),
        charge((0.0, 0.0, heading + 1.5), charge_per_radian=0.01),
    )
    assert turned - straight == pytest.approx(0.015)


def test_a_metre_at_cruise_costs_about_a_hundredth(costs: mut.LegCosts) -> None:
    leg = costs.between("supply_B", "supply_A")
    assert leg is not None
    assert 0.008 * leg.length < leg.charge < 0.011 * leg.length


def test_only_legs_that_come_near_the_bed_are_felt_by_the_patient(costs: mut.LegCosts) -> None:
    far, near = costs.between("home", "pharmacy_south"), costs.between("supply_A", "patient_bed_left")
    assert far is not None
    assert near is not None
    assert far.discomfort == 0.0
    assert near.discomfort > 1.0


def test_discomfort_of_a_slow_drive_by_hand(ward: Ward, costs: mut.LegCosts) -> None:
    # Standing 0.8 m from the bed: closeness 1 - 0.8 / 3, times 0.25 a second.
    assert costs.standing_discomfort("patient_bed_left", 20.0) == pytest.approx(20.0 * 0.25 * (1 - 0.8 / 3), rel=1e-6)


def test_turning_the_robot_round_at_the_start_adds_half_a_turn(ward: Ward, costs: mut.LegCosts) -> None:
    path = leg_planner(ward).between("home", "supply_B")
    assert path is not None
    dx, dy = path.points[1] - path.points[0]
    heading = math.atan2(dy, dx)
    along, against = (
        costs.from_pose((0.0, 0.0, heading), "supply_B"),
        costs.from_pose((0.0, 0.0, heading + math.pi), "supply_B"),
    )
    assert along is not None
    assert against is not None
    assert against.time - along.time == pytest.approx(math.pi / mut.LegCalibration().turn_rate, rel=0.02)
    assert against.length == along.length


def test_a_leg_from_a_places_own_pose_is_the_leg_between_the_places(ward: Ward, costs: mut.LegCosts) -> None:
    place = ward.place["supply_A"]
    assert costs.from_pose((place.x, place.y, place.yaw), "patient_bed_left") == costs.between(
        "supply_A", "patient_bed_left"
    )


def test_there_is_no_leg_where_there_is_no_way(tmp_path: Path) -> None:
    text = "name: cell\nhalf_extent: 6.0\nwall_half_thickness: 0.2\nwall_height: 2.0\nbackground_congestion: 0.1\n"
    text += "places:\n"
    text += "- {name: home, x: -3.0, y: 0.0, yaw: 0.0, category: home}\n"
    text += "- {name: pharmacy_north, x: 3.0, y: 0.0, yaw: 0.0, category: pharmacy}\n"
    text += (
        "furniture:\n- {name: wall, model: partition, x: 0.0, y: 0.0, half_length: 0.1, half_width: 7.0, height: 2.0}\n"
    )
    path = tmp_path / "cell.ward.yaml"
    path.write_text(text)
    assert mut.LegCosts(LoadWard(path)).between("home", "pharmacy_north") is None


def test_predictions_are_sums_over_the_profile_that_the_controller_follows(ward: Ward, costs: mut.LegCosts) -> None:
    """Discomfort against a robot moved along the path in small steps of time."""
    route = leg_planner(ward).between("pharmacy_north", "patient_bed_right")
    assert route is not None
    path = make_drive_path(route, Congestion(ward))
    rates = FeatureRates(ward)
    times = np.arange(0.0, path.duration, 0.01) + 0.005
    arcs = np.interp(times, path.times, path.lengths)
    points = np.stack([np.interp(arcs, path.lengths, path.points[:, i]) for i in (0, 1)], axis=1)
    speeds = np.gradient(arcs, 0.01)
    driven = float(np.sum(rates.discomfort_rate(points, speeds)) * 0.01)
    leg = costs.between("pharmacy_north", "patient_bed_right")
    assert leg is not None
    at_the_end = leg.discomfort - driven  # Turning and settling at the bedside.
    seconds = at_the_end / costs.standing_discomfort("patient_bed_right", 1.0)
    assert 2.2 < seconds < 3.5
