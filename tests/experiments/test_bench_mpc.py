import numpy as np

import mala_drake.experiments.bench_mpc as mut
from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.ward.routes import RoutePlanner
from mala_drake.ward.shapes import ShapeDistances


def test_the_course_fills_all_slots_and_its_route_does_not_know_the_bucket():
    assert len((*mut.MAPPED, mut.UNMAPPED)) == OptimalControlProblem().layout.slots
    route = RoutePlanner(mut.MAPPED).route(mut.START, mut.GOAL[:2])
    along = np.vstack([np.linspace(a, b, 50) for a, b in zip(route.points[:-1], route.points[1:], strict=True)])
    assert ShapeDistances([mut.UNMAPPED])(along).min() < 0.28 + 0.1


def test_the_course_is_driven_to_its_end_without_contact():
    problem = OptimalControlProblem()
    run = mut.drive_course(problem, MakeSolver("snopt", problem), steps=80, seed=0)
    assert run.failures == 0
    assert run.min_clearance > 0.05
    assert run.position_error < 0.15


def test_the_benchmark_has_a_row_a_solver_with_its_times():
    rows = mut.bench_mpc(("snopt",), steps=3, seeds=(0, 1))
    assert [row["solver"] for row in rows] == ["snopt"]
    assert rows[0]["solves"] == 6
    assert 0 < rows[0]["median_ms"] <= rows[0]["p95_ms"] <= rows[0]["max_ms"]
