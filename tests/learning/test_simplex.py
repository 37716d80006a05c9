import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.solvers import ClarabelSolver, MathematicalProgram

from mala_drake.learning import project_onto_simplex

vectors = st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=7).map(np.array)


def projection_by_quadratic_program(point):
    program = MathematicalProgram()
    w = program.NewContinuousVariables(point.size)
    program.AddQuadraticErrorCost(1.0, point, w)
    program.AddBoundingBoxConstraint(0.0, 1.0, w)
    program.AddLinearEqualityConstraint(np.ones((1, point.size)), [1.0], w)
    return ClarabelSolver().Solve(program).GetSolution(w)


@given(vectors)
def test_the_projection_lies_on_the_simplex(point):
    projection = project_onto_simplex(point)
    assert np.all(projection >= 0.0)
    assert math.fsum(projection) == pytest.approx(1.0, abs=1e-14)


@given(vectors)
def test_it_satisfies_the_optimality_conditions(point):
    projection = project_onto_simplex(point)
    # Stationarity with one multiplier for the sum: what is taken from positive entries is the same for all, and from
    # entries at zero no more than they would need to stay there.
    taken = point - projection
    positive = projection > 0.0
    threshold = taken[positive].mean()
    np.testing.assert_allclose(taken[positive], threshold, atol=1e-12)
    assert np.all(taken[~positive] <= threshold + 1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_a_quadratic_program_finds_the_same_point(seed):
    generator = np.random.default_rng(seed)
    point = generator.normal(scale=1.0, size=generator.integers(1, 8))
    np.testing.assert_allclose(project_onto_simplex(point), projection_by_quadratic_program(point), atol=1e-5)


@given(vectors, st.integers(0, 1000))
def test_no_other_point_of_the_simplex_is_nearer(point, seed):
    others = np.random.default_rng(seed).dirichlet(np.ones(point.size), size=20)
    distance = np.linalg.norm(point - project_onto_simplex(point))
    assert np.all(distance <= np.linalg.norm(point - others, axis=1) + 1e-12)


@given(vectors)
def test_points_of_the_simplex_stay_where_they_are(point):
    projection = project_onto_simplex(point)
    np.testing.assert_allclose(project_onto_simplex(projection), projection, atol=1e-15)


@given(vectors, st.floats(-1e6, 1e6))
def test_shifting_all_entries_changes_nothing(point, shift):
    np.testing.assert_allclose(project_onto_simplex(point + shift), project_onto_simplex(point), atol=1e-8)


@pytest.mark.parametrize("point", [[], [np.nan, 0.5], [np.inf, 0.0], [[0.5, 0.5]], 1.0])
def test_what_is_no_finite_vector_is_refused(point):
    with pytest.raises(ValueError, match="onto the simplex"):
        project_onto_simplex(point)
