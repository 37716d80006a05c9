"""What the tests of the optimal control problem share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from mala_drake.control import (
    ConstraintParameters,
    MakeSolver,
    MpcParameters,
    OptimalControlProblem,
    Solver,
    StageParameters,
    TerminalParameters,
)

from .controller_bench import ControllerBench


@pytest.fixture(scope="session")
def problem() -> OptimalControlProblem:
    """The problem of the hospital case: it is immutable, so all tests share one."""
    return OptimalControlProblem()


@pytest.fixture(scope="session")
def snopt(problem: OptimalControlProblem) -> Solver:
    return MakeSolver("snopt", problem)


@pytest.fixture(scope="session")
def rti(problem: OptimalControlProblem) -> Solver:
    return MakeSolver("rti", problem)


@pytest.fixture
def bench(problem: OptimalControlProblem) -> ControllerBench:
    """A controller with SNOPT."""
    return ControllerBench(problem)


@pytest.fixture(scope="session")
def parameters_toward() -> Callable[..., MpcParameters]:
    """A factory: the parameters that pull to one state at every stage."""

    def make(target: tuple[float, ...], *, speed_limit: float = 1.5, **constraints: object) -> MpcParameters:
        goal = np.zeros(6)
        goal[: len(target)] = target
        return MpcParameters(
            TerminalParameters(goal),
            StageParameters(np.tile(goal, (20, 1))),
            ConstraintParameters(np.full(20, speed_limit), **constraints),
        )

    return make
