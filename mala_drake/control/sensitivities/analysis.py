"""The sensitivities of one optimal control problem: from a solver's solution to its derivatives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import MpcParameters
from mala_drake.control.solution import Solution
from mala_drake.messages import Message

from .columns import GROUPS, LOWER, UPPER, Columns
from .interior_point import BARRIER, InteriorPoint
from .kinks import KinkDistances
from .kkt_point import KktPoint
from .parameter_terms import ParameterTerms
from .policy_sensitivity import policy_sensitivity
from .primal_dual_sensitivity import PrimalDualSensitivity, primal_dual_sensitivity
from .regularity import Regularity, regularity

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PolicySensitivity(Message):
    """pi(z, p) and its derivatives at one point."""

    control: Vector  # u_0 on the central path, shape (3,).
    jacobian: Vector  # d u_0 / d (p, z_0), shape (3, n), in the order of `Columns`; nan where there is none.
    regularity: Regularity


class SensitivityAnalysis:
    """Derivatives of the solutions of one problem, by the implicit function theorem (paper, eq. IFT).

    The theorem is applied to the primal-dual barrier system kappa_nu = 0, whose solution is smooth wherever
    it is a strict minimum and is that of the problem up to the order of nu. Every result carries its
    `Regularity`, and derivatives that do not exist are nan. One instance serves one user: it owns work arrays.
    """

    def __init__(self, problem: OptimalControlProblem, *, barrier: float = BARRIER) -> None:
        """Prepares the analysis; CasADi functions are created at first use.

        Args:
            problem: the problem, which is only read.
            barrier: nu, in units of the cost.
        """
        self.columns = Columns(problem.layout)
        self._problem = problem
        self._others: dict[int, SensitivityAnalysis] = {}
        self._interior_point = InteriorPoint(problem, barrier=barrier)
        self._terms = ParameterTerms(self._interior_point.functions)
        self._kinks = KinkDistances(self._interior_point.functions)

    def of_horizon(self, horizon: int) -> SensitivityAnalysis:
        """That of the same problem with another number of stages: itself, or one made at its first use and kept."""
        if horizon == self._problem.horizon:
            return self
        if horizon not in self._others:
            problem = self._problem.of_horizon(horizon)
            self._others[horizon] = SensitivityAnalysis(problem, barrier=self._interior_point.barrier)
        return self._others[horizon]

    def polish(self, solution: Solution, initial_state: ArrayLike, parameters: MpcParameters) -> KktPoint:
        """The point of the central path next to a solution of any solver; see `InteriorPoint.polish`.

        A solver with hard clearance solves another problem where that constraint presses: the point is then that of the
        penalty's own solution, and its `distance` from the solver's tells.
        """
        return self._interior_point.polish(solution.controls, initial_state, parameters, duals=solution.control_duals)

    def regularity(self, point: KktPoint) -> Regularity:
        """Whether the theorem holds at the point, and by how much."""
        return regularity(point, self._interior_point.sweeps, self._kinks)

    def policy(self, point: KktPoint, groups: Iterable[str] = GROUPS) -> PolicySensitivity:
        """The derivative d pi / d (p, z_0) for the columns of `groups`, which are names of groups or pieces."""
        conditions = self.regularity(point)
        jacobian = policy_sensitivity(point, self._terms, self.columns, tuple(groups))
        self._void(jacobian, point, conditions)
        return PolicySensitivity(point.controls[0].copy(), jacobian, conditions)

    def primal_dual(self, point: KktPoint, groups: Iterable[str] = GROUPS) -> tuple[PrimalDualSensitivity, Regularity]:
        """The derivative d zeta / d (p, z_0) for the columns of `groups`, with the conditions."""
        conditions = self.regularity(point)
        sensitivity = primal_dual_sensitivity(point, self._terms, self.columns, tuple(groups))
        for item in fields(sensitivity):
            self._void(getattr(sensitivity, item.name), point, conditions)
        return sensitivity, conditions

    def _void(self, derivatives: Vector, point: KktPoint, conditions: Regularity) -> None:
        """Overwrites derivatives that do not exist."""
        if not conditions.differentiable:
            derivatives[:] = np.nan
        # A bound that is also the other bound can move only with it.
        both = np.flatnonzero(point.parameters.inputs.lower >= point.parameters.inputs.upper)
        for name in (LOWER, UPPER):
            derivatives[..., self.columns.slices[name].start + both] = np.nan
