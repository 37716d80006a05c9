"""What the tests of sensitivities share: a small problem with every kind of term, and two independent references.

The references are the problem in its multiple-shooting form, stated anew over w = (z_0 ... z_N, u_0 ... u_{N-1}) with
dense derivatives, and central differences of solutions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi
import numpy as np
import pytest

from mala_drake.control import (
    ConstraintParameters,
    DynamicsParameters,
    InputParameters,
    MakeSolver,
    MpcParameters,
    OptimalControlProblem,
    StageParameters,
    TerminalParameters,
    model,
)
from mala_drake.control.penalty import huberised_hinge
from mala_drake.control.sensitivities import INITIAL_STATE, LOWER, UPPER, Columns
from mala_drake.control.sensitivities.interior_point import InteriorPoint
from mala_drake.control.shooting import (
    LIMIT_BUFFER,
    OBSTACLE_BUFFER,
    limit_margins,
    obstacle_margins,
    parameter_pieces,
)
from mala_drake.messages import Shape

HORIZON = 4
STATE = np.array([0.1, -0.05, 0.2, 0.8, 0.02, 0.3])
GOAL = np.array([0.9, 0.35, 0.5, 0.6, 0.0, 0.2])
BOX = Shape("box", 0.55, 0.52, 0.3, 0.1, 0.05, 0.02)


class PackedProblem(OptimalControlProblem):
    """The problem with an offset on the packed parameters, which so can be moved entry by entry."""

    offset: tuple[int, float] | None = None

    def pack(self, initial_state, parameters):
        packed = super().pack(initial_state, parameters)
        if self.offset is not None:
            packed[self.offset[0]] += self.offset[1]
        return packed


@pytest.fixture(scope="session")
def small():
    return PackedProblem(horizon=HORIZON, obstacle_slots=2)


@pytest.fixture(scope="session")
def start():
    return STATE


@pytest.fixture(scope="session")
def choose():
    """A factory: parameters that lead past an obstacle, against the speed limit and against bounds of the controls."""

    def make(*, horizon=HORIZON, goal=GOAL, inputs=None, **constraints):
        usual = {"speed_limits": np.full(horizon, 0.85), "obstacles": (BOX,), "limit_penalty": 300.0}
        return MpcParameters(
            TerminalParameters(goal, 40 * np.array([3.0, 3.0, 1.0, 1.0, 1.0, 1.0])),
            StageParameters(np.linspace(STATE, goal, horizon, endpoint=False) + 0.03, np.array([9.0, 9, 3, 2, 1, 1])),
            ConstraintParameters(**{**usual, "obstacle_penalty": 700.0, **constraints}),
            DynamicsParameters(4.0, 0.1, 0.2, 0.97, 1.02, 0.95),
            inputs or InputParameters(np.array([-1.0, 0.0, -0.8]), np.array([1.0, 1.5, 0.8])),
        )

    return make


class Solves:
    """(state, parameters) -> the point of the central path; `near` is a point to start at instead of a solver."""

    def __init__(self, problem, solver):
        self._problem = problem
        self._columns = Columns(problem.layout)
        self._solver = solver
        self._searches = {}

    def __call__(self, state, chosen, barrier=1e-7, near=None, offset=None):
        self._problem.offset = offset
        try:
            if near is None:
                solution = self._solver.solve(state, chosen)
                assert solution.success
                controls, duals = solution.controls, solution.control_duals
            else:
                controls, duals = near.controls, near.lower_multipliers - near.upper_multipliers
            search = self._searches.setdefault(barrier, InteriorPoint(self._problem, barrier=barrier))
            point = search.polish(controls, state, chosen, duals=duals)
        finally:
            self._problem.offset = None
        assert point.converged
        return point

    def perturbed(self, point, column, size):
        """The point after one column of (p, bounds, z_0) has moved by `size`."""
        slices = self._columns.slices
        name = next(name for name, place in slices.items() if place.start <= column < place.stop)
        entry = column - slices[name].start
        state, chosen, offset = point.initial_state, point.parameters, None
        if name == INITIAL_STATE:
            state = _moved(state, entry, size)
        elif name in (LOWER, UPPER):
            bound = name.split(".")[1]
            inputs = replace(chosen.inputs, **{bound: _moved(getattr(chosen.inputs, bound), entry, size)})
            chosen = replace(chosen, inputs=inputs)
        else:
            offset = (column, size)
        return self(state, chosen, point.barrier, point, offset)


def _moved(array, entry, size):
    array = np.array(array)
    array[entry] += size
    return array


@pytest.fixture(scope="session")
def solve(small):
    return Solves(small, MakeSolver("snopt", small, tolerance=1e-7))


@pytest.fixture(scope="session")
def full():
    """The problem of the hospital case, N = 20, and its solves."""
    problem = PackedProblem()
    return problem, Solves(problem, MakeSolver("rti", problem))


@pytest.fixture(scope="session")
def perturbed(solve):
    return solve.perturbed


@dataclass(frozen=True)
class MultipleShooting:
    """The paper's nonlinear program, dense: Phi(w, p) subject to G(w, z_0, p) = 0 and bounds on the controls."""

    problem: OptimalControlProblem

    @cached_property
    def symbols(self):
        horizon = self.problem.horizon
        names = {"states": (6, horizon + 1), "controls": (3, horizon), "initial_state": (6, 1), "lower": (3, 1)}
        names |= {"upper": (3, 1), "parameters": (self.problem.layout.size, 1)}
        names |= {"costates": (6, horizon + 1), "lower_multipliers": (3, horizon), "upper_multipliers": (3, horizon)}
        return {name: casadi.SX.sym(name, *shape) for name, shape in names.items()}

    @cached_property
    def cost(self):
        s = self.symbols
        pieces = parameter_pieces(self.problem.layout, s["parameters"])

        def square(error, weights):
            return casadi.dot(weights, error**2)

        cost = square(s["states"][:, -1] - pieces["terminal.target"], pieces["terminal.weights"])
        for k in range(self.problem.horizon):
            cost += square(s["states"][:, k] - pieces["stage.references"][k, :].T, pieces["stage.state_weights"])
            cost += square(s["controls"][:, k], pieces["stage.control_weights"])
            reached = s["states"][:, k + 1]
            for margins, buffer, slope in (
                (obstacle_margins(reached, pieces), OBSTACLE_BUFFER, "obstacle_penalty"),
                (limit_margins(reached, k, pieces), LIMIT_BUFFER, "limit_penalty"),
            ):
                cost += pieces[f"constraints.{slope}"] * casadi.sum1(huberised_hinge(buffer - margins, buffer))
            backward = huberised_hinge(-reached[3], LIMIT_BUFFER)
            cost += pieces["constraints.reverse_braking_penalty"] * s["controls"][1, k] * backward
        return cost

    @cached_property
    def equations(self):
        """G, with one column for each state, in the order and sign of `KktPoint.costates`."""
        s = self.symbols
        dynamics = parameter_pieces(self.problem.layout, s["parameters"])["dynamics"]
        columns = [s["initial_state"] - s["states"][:, 0]]
        for k in range(self.problem.horizon):
            step = model.step(s["states"][:, k], s["controls"][:, k], dynamics, self.problem.period)
            columns.append(step - s["states"][:, k + 1])
        return casadi.horzcat(*columns)

    @cached_property
    def kappa(self):
        """The primal-dual barrier system, less nu in its last rows."""
        s = self.symbols
        horizon = self.problem.horizon
        below = s["controls"] - casadi.repmat(s["lower"], 1, horizon)
        above = casadi.repmat(s["upper"], 1, horizon) - s["controls"]
        lagrangian = self.cost + casadi.dot(s["costates"], self.equations)
        lagrangian -= casadi.dot(s["lower_multipliers"], below) + casadi.dot(s["upper_multipliers"], above)
        w = casadi.veccat(s["states"], s["controls"])
        gaps = casadi.veccat(s["lower_multipliers"] * below, s["upper_multipliers"] * above)
        return casadi.vertcat(casadi.gradient(lagrangian, w), casadi.vec(self.equations), gaps)

    @cached_property
    def variables(self):
        names = ("states", "controls", "costates", "lower_multipliers", "upper_multipliers")
        return casadi.veccat(*(self.symbols[name] for name in names))

    @cached_property
    def columns(self):
        return casadi.vertcat(*(self.symbols[name] for name in ("parameters", "lower", "upper", "initial_state")))

    def arguments(self, point):
        """The values of all symbols at a point, in the order of `symbols`."""
        inputs = point.parameters.inputs
        return [
            *(point.states.T, point.controls.T, point.initial_state, inputs.lower, inputs.upper, point.packed),
            *(point.costates.T, point.lower_multipliers.T, point.upper_multipliers.T),
        ]

    def evaluate(self, expressions, point):
        function = casadi.Function("reference", list(self.symbols.values()), expressions)
        values = function(*self.arguments(point))
        return [value.full() for value in (values if isinstance(values, tuple) else (values,))]


@pytest.fixture(scope="session")
def reference(small):
    return MultipleShooting(small)
