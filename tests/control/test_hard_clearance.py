import numpy as np

from mala_drake.control import MakeSolver, Status
from mala_drake.messages import Shape

WALL = Shape("wall", 2.0, 0.0, 0.0, 0.2, 3.0)
START = np.array([0.0, 0.0, 0.0, 0.5, 0.0, 0.0])


def test_no_pull_overcomes_the_hard_clearance_where_a_weak_penalty_gives_way(problem, parameters_toward):
    beyond_the_wall = parameters_toward((3.5,), obstacles=(WALL,), obstacle_penalty=500.0)
    soft = MakeSolver("snopt", problem).solve(START, beyond_the_wall)
    hard = MakeSolver("snopt", problem, hard_clearance=True).solve(START, beyond_the_wall)
    assert soft.obstacle_margins.min() < -0.1
    assert hard.success
    assert hard.obstacle_margins.min() > -1e-4
    assert hard.cost > soft.cost
    # The constraint carries what the penalty cannot.
    assert hard.obstacle_duals.max() > 500.0


def test_a_start_inside_the_clearance_is_still_solved(problem, parameters_toward):
    touching = START + np.array([1.5, 0, 0, -0.5, 0, 0])
    solution = MakeSolver("snopt", problem, hard_clearance=True).solve(
        touching, parameters_toward((1.0,), obstacles=(WALL,))
    )
    assert solution.success
    assert solution.states[-1, 0] < 1.2


def test_where_the_penalty_suffices_the_solution_is_the_same(problem, parameters_toward):
    box = Shape("box", 1.5, 0.25, 0.3, 0.3, 0.2, 0.05)
    parameters = parameters_toward((3.0, 0.3), obstacles=(box,))
    soft = MakeSolver("snopt", problem, tolerance=1e-6).solve(START, parameters)
    # The same starting point, so that both find the same of the local optima.
    constrained = MakeSolver("snopt", problem, tolerance=1e-6, hard_clearance=True)
    hard = constrained.solve(START, parameters, soft.controls + 0.02)
    assert soft.obstacle_duals.max() > 100.0
    np.testing.assert_allclose(hard.controls, soft.controls, atol=1e-3)
    np.testing.assert_allclose(hard.obstacle_duals, soft.obstacle_duals, atol=2.0)


def test_a_constraint_that_fails_is_reported(problem, parameters_toward, monkeypatch):
    solver = MakeSolver("snopt", problem, hard_clearance=True)
    parameters = parameters_toward((1.0,), obstacles=(WALL,))

    def fail():
        raise RuntimeError("broken on purpose")

    with monkeypatch.context() as patch:
        patch.setattr(solver._program._clearance._function, "_evaluate", fail)
        assert solver.solve(START, parameters).status is Status.NUMERICAL
    assert solver.solve(START, parameters).success
