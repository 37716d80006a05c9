"""The solvers agree on a few hundred states that closed loops visit, and what differs is shown to be a minimum."""

import dataclasses
from collections import Counter

import numpy as np
import pytest

import mala_drake.experiments.solver_agreement as mut
from mala_drake.control import MakeSolver, OptimalControlProblem, Status
from mala_drake.experiments.bench_agreement import agreement, precise, visited
from mala_drake.experiments.model_drive import run_drive
from mala_drake.experiments.model_drives import course
from mala_drake.experiments.solver_agreement import Verdict


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


@pytest.fixture(scope="module")
def samples(problem):
    """Every third step of the course in three closed loops: obstacles in all slots, the end in a pose."""
    solver = MakeSolver("rti", problem)
    return [s for seed in range(3) for s in run_drive(problem, solver, course(), seed=seed).samples[::3]]


def test_rti_agrees_with_snopt_and_differing_minima_are_few(problem, samples):
    counts = Counter(c.verdict for c in mut.compare(precise("snopt", problem), precise("rti", problem), samples))
    assert counts[Verdict.DISAGREEMENT] == counts[Verdict.FAILURE] == 0
    assert counts[Verdict.SAME] > 0.95 * len(samples)


@pytest.mark.slow
def test_all_solvers_agree_on_the_hard_legs_of_the_ward_too(problem):
    samples = visited(problem)
    assert len(samples) > 400
    for name, some in (("rti", samples), ("ipopt", samples[::8])):
        row = agreement(precise("snopt", problem), precise(name, problem), some, 1e-5)
        assert row["disagreement"] == row["failure"] == 0
        assert row["same"] > 0.95 * len(some)
        assert row["largest_difference_of_same"] < 2e-3


class Answering:
    """A solver that gives prepared answers, from cold and when asked to go on from another answer."""

    name = "answering"

    def __init__(self, solution, **changes):
        self._cold = dataclasses.replace(solution, **changes)
        self._others = {}

    def finds(self, start, cost):
        self._others[start.controls.tobytes()] = dataclasses.replace(self._cold, cost=cost)
        return self

    def solve(self, state, parameters, warm_start=None):
        return self._cold if warm_start is None else self._others[warm_start.tobytes()]


@pytest.fixture(scope="module")
def sample(samples):
    return dataclasses.replace(samples[0], warm_start=None)


def both(sample, one_cost, two_cost):
    one = dataclasses.replace(sample.solution, cost=one_cost)
    two = dataclasses.replace(sample.solution, cost=two_cost, controls=np.ones((20, 3)))
    return one, two


@pytest.mark.parametrize(("cost", "verdict"), [(9.0, Verdict.BETTER_MINIMUM), (11.0, Verdict.WORSE_MINIMUM)])
def test_a_difference_that_neither_can_improve_is_another_minimum(sample, cost, verdict):
    one, two = both(sample, 10.0, cost)
    reference, other = Answering(one).finds(two, cost), Answering(two).finds(one, 10.0)
    assert mut.compare(reference, other, [sample])[0].verdict is verdict


def test_a_difference_that_one_of_them_can_improve_is_a_disagreement(sample):
    one, two = both(sample, 10.0, 11.0)
    reference, other = Answering(one).finds(two, 10.0), Answering(two).finds(one, 10.0)
    assert mut.compare(reference, other, [sample])[0].verdict is Verdict.DISAGREEMENT


def test_an_answer_that_is_no_optimum_by_its_own_word_is_a_failure(sample):
    one, two = both(sample, 10.0, 10.0)
    other = Answering(two, status=Status.ITERATION_LIMIT)
    assert mut.compare(Answering(one), other, [sample])[0].verdict is Verdict.FAILURE


def test_costs_a_thousandth_apart_are_the_same(sample):
    one, two = both(sample, 10.0, 10.009)
    comparison = mut.compare(Answering(one), Answering(two), [sample])[0]
    assert comparison.verdict is Verdict.SAME
    assert comparison.difference == pytest.approx(9e-4)
