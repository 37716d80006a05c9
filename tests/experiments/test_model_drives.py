import numpy as np

import mala_drake.experiments.model_drives as mut
from mala_drake.control import OptimalControlProblem
from mala_drake.ward.routes import BODY_RADIUS, RoutePlanner
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import LoadWard


def test_the_course_fills_all_slots_and_its_route_does_not_know_the_bucket():
    assert len((*mut.MAPPED, mut.UNMAPPED)) == OptimalControlProblem().layout.slots
    route = RoutePlanner(mut.MAPPED).route(mut.START, mut.GOAL[:2])
    along = np.vstack([np.linspace(a, b, 50) for a, b in zip(route.points[:-1], route.points[1:], strict=True)])
    assert ShapeDistances([mut.UNMAPPED])(along).min() < 0.28 + 0.1


def passed(drive):
    """How many shapes come within 0.3 m of the body on the way, the ends left out."""
    path = drive.track.path
    middle = path.points[(path.lengths > 0.6) & (path.lengths < path.length - 0.6)]
    return int((ShapeDistances(drive.shapes)(middle).min(axis=0) - BODY_RADIUS < 0.3).sum())


def test_hard_legs_pass_more_shapes_closely_than_a_plain_one():
    legs = mut.hard_legs(count=4)
    assert len({leg.name.split(" -> ")[0] for leg in legs}) == 4
    assert len({leg.name.split(" -> ")[1] for leg in legs}) == 4
    assert min(passed(leg) for leg in legs) > passed(mut.ward_leg(LoadWard(), "home", "charge_main"))


def test_a_leg_starts_at_rest_in_its_place_and_sees_only_what_is_near():
    ward = LoadWard()
    leg = mut.ward_leg(ward, "home", "supply_A")
    home = ward.place["home"]
    np.testing.assert_allclose(leg.start, [home.x, home.y, home.yaw, 0, 0, 0])
    seen = leg.seen(14.0, 9.0)
    assert 0 < len(seen) < len(ward.shapes)
    assert leg.steps * 0.2 > leg.track.path.duration
