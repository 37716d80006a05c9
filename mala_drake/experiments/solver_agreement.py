"""Whether solvers of one problem agree: the same samples given to each, and every difference explained.

Two solvers can end at different local optima, for example on either side of an obstacle. A difference in cost is
*another minimum* only if each solver, started at the other's solution, sees nothing to improve there; else it is a
*disagreement*. Neither is hidden.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from mala_drake.control import Solution, Solver

from .model_drive import Sample

RELATIVE = 1e-3
"""Difference in cost, relative, under which two solutions are one."""

ABSOLUTE = 2e-3
"""The same as a number: what the solvers' common tolerance leaves of a cost near zero."""


class Verdict(StrEnum):
    """How two answers to one sample compare."""

    SAME = "same"  # Costs within `RELATIVE`.
    BETTER_MINIMUM = "better_minimum"  # Another local optimum, of lower cost than the reference's.
    WORSE_MINIMUM = "worse_minimum"  # Another local optimum, of higher cost.
    DISAGREEMENT = "disagreement"  # One of the two is no local optimum.
    FAILURE = "failure"  # One of the two says itself that it is none.


@dataclass(frozen=True, slots=True)
class Comparison:
    """The answers of the reference and of another solver to one sample."""

    verdict: Verdict
    reference_cost: float
    cost: float

    @property
    def difference(self) -> float:
        """Of the costs, relative to the reference's."""
        return (self.cost - self.reference_cost) / max(abs(self.reference_cost), ABSOLUTE / RELATIVE)


def compare(reference: Solver, other: Solver, samples: Sequence[Sample]) -> list[Comparison]:
    """Gives each sample to both, with the same warm start."""
    return [_compare_one(reference, other, sample) for sample in samples]


def _compare_one(reference: Solver, other: Solver, sample: Sample) -> Comparison:
    one = reference.solve(sample.state, sample.parameters, sample.warm_start)
    two = other.solve(sample.state, sample.parameters, sample.warm_start)
    return Comparison(_verdict(reference, other, sample, one, two), one.cost, two.cost)


def _verdict(reference: Solver, other: Solver, sample: Sample, one: Solution, two: Solution) -> Verdict:
    if not (one.success and two.success):
        return Verdict.FAILURE
    if _close(one.cost, two.cost):
        return Verdict.SAME
    if _stays(reference, sample, two) and _stays(other, sample, one):
        return Verdict.BETTER_MINIMUM if two.cost < one.cost else Verdict.WORSE_MINIMUM
    return Verdict.DISAGREEMENT


def _stays(solver: Solver, sample: Sample, solution: Solution) -> bool:
    """Whether the solution is a local optimum to `solver` too."""
    again = solver.solve(sample.state, sample.parameters, solution.controls)
    return again.success and _close(again.cost, solution.cost)


def _close(one: float, two: float) -> bool:
    return abs(one - two) <= RELATIVE * min(abs(one), abs(two)) + ABSOLUTE
