import numpy as np
import pytest

import mala_drake.control.solver_by_horizon as mut
from mala_drake.control import (
    ConstraintParameters,
    MakeSolver,
    MpcParameters,
    OptimalControlProblem,
    StageParameters,
    TerminalParameters,
)
from mala_drake.errors import BadInput

START = np.array([-1.0, 0.02, 0.0, 0.6, 0.0, 0.0])


def to_the_origin(horizon):
    return MpcParameters(
        TerminalParameters(np.zeros(6)),
        StageParameters(np.zeros((horizon, 6))),
        ConstraintParameters(np.full(horizon, 1.5)),
    )


@pytest.mark.parametrize("name", ["snopt", "rti"])
def test_each_horizon_gets_the_answer_of_its_own_problem(problem, name):
    solver = mut.SolverByHorizon(name, problem)
    for horizon in (7, 20, 7):
        found = solver.solve(START, to_the_origin(horizon))
        own = MakeSolver(name, OptimalControlProblem(horizon=horizon)).solve(START, to_the_origin(horizon))
        assert found.success
        assert found.controls.tobytes() == own.controls.tobytes()


def test_a_warm_start_is_cut_to_the_horizon_or_held_over_it(problem):
    class Recording:
        def solve(self, state, parameters, warm_start=None):
            self.warm_start = warm_start

    solver, inner = mut.SolverByHorizon("rti", problem), Recording()
    solver._solvers = {3: inner, 20: inner}
    controls = np.arange(15.0).reshape(5, 3)
    solver.solve(START, to_the_origin(3), controls)
    np.testing.assert_array_equal(inner.warm_start, controls[:3])
    solver.solve(START, to_the_origin(20), controls)
    np.testing.assert_array_equal(inner.warm_start, np.vstack((controls, np.tile(controls[-1], (15, 1)))))
    solver.solve(START, to_the_origin(3))
    assert inner.warm_start is None


def test_as_the_horizon_shrinks_the_plan_is_carried_out_to_its_end(problem):
    """Bellman: without disturbances each later plan is the rest of the first one."""
    solver = mut.SolverByHorizon("rti", problem, tolerance=1e-7, sqp_iterations=100)
    first = solver.solve(START, to_the_origin(12))
    state, warm_start = START, None
    for horizon in range(12, 3, -1):
        solution = solver.solve(state, to_the_origin(horizon), warm_start)
        np.testing.assert_allclose(solution.states[-1], first.states[-1], atol=1e-3)
        state, warm_start = solution.states[1], solution.shifted()
    np.testing.assert_allclose(state, first.states[9], atol=1e-3)


def test_an_unknown_solver_is_refused_at_once(problem):
    with pytest.raises(BadInput, match="fmincon"):
        mut.SolverByHorizon("fmincon", problem)
