"""From any solver's solution to the central path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import MpcParameters

from .central_path import CentralPathSearch
from .kkt_point import KktPoint
from .stage_functions import StageFunctions
from .sweeps import Sweeps

BARRIER = 1e-7
"""nu in units of the cost, some 1e-9 of a typical one: a bound with multiplier mu is kept at distance nu / mu."""


class InteriorPoint:
    """Finds `KktPoint`s of one problem. Owns work arrays: one instance serves one user."""

    def __init__(self, problem: OptimalControlProblem, *, barrier: float = BARRIER, iteration_limit: int = 60) -> None:
        """Prepares the functions.

        Args:
            problem: what is solved.
            barrier: nu, in units of the cost.
            iteration_limit: Newton steps at each barrier.
        """
        self.problem = problem
        self.barrier = barrier
        self.functions = StageFunctions(problem)
        self.sweeps = Sweeps(self.functions)
        self._iteration_limit = iteration_limit

    def polish(
        self,
        controls: ArrayLike,
        initial_state: ArrayLike,
        parameters: MpcParameters,
        *,
        duals: ArrayLike | None = None,
        first_control: ArrayLike | None = None,
        barriers: Sequence[float] = (),
    ) -> KktPoint:
        """The point of the central path next to a solution: a few Newton steps, the same for the same arguments.

        Args:
            controls: of the solution, shape (N, 3), usually `Solution.controls`.
            initial_state: z_0, shape (6,).
            parameters: what was solved for.
            duals: `Solution.control_duals`, shape (N, 3); without them the start is taken for no solution.
            first_control: fixes u_0, shape (3,), which then is no variable.
            barriers: larger values of nu to go through before, for starts that are no solution.

        Returns:
            The point; `converged` says whether it is one, `distance` how far from the solution.
        """
        state = np.array(initial_state, dtype=float)
        packed = self.problem.pack(state, parameters)
        horizon = self.problem.horizon
        lower, upper = (np.tile(b, (horizon, 1)) for b in (parameters.inputs.lower, parameters.inputs.upper))
        if first_control is not None:
            lower[0] = upper[0] = first_control
        start = np.clip(np.asarray(controls, dtype=float), lower, upper)
        self.sweeps.set_parameters(state, packed)
        search = CentralPathSearch(self.sweeps, lower, upper, 2 * parameters.stage.control_weights)
        reached, iterations = start, 0
        multipliers = np.zeros_like(start) if duals is None else np.asarray(duals, dtype=float)
        for barrier in (*barriers, self.barrier):
            point = search.run(reached, multipliers, barrier, self._iteration_limit)
            reached, iterations = point.controls, iterations + point.iterations
            multipliers = point.lower_multipliers - point.upper_multipliers
        slices = self.problem.layout.slices
        reference = packed[slices["stage.references"]][: len(state)]
        first_node = 2 * packed[slices["stage.state_weights"]] * (state - reference)
        return KktPoint(
            initial_state=state,
            parameters=parameters,
            packed=packed,
            lower=lower,
            upper=upper,
            barrier=self.barrier,
            controls=point.controls,
            states=point.states,
            costates=np.vstack((point.factorisation.initial_costate + first_node, point.factorisation.costates)),
            lower_multipliers=point.lower_multipliers,
            upper_multipliers=point.upper_multipliers,
            factorisation=point.factorisation,
            converged=point.converged,
            iterations=iterations,
            residual=point.residual,
            distance=float(np.abs(point.controls - start).max()),
        )
