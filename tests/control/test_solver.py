import subprocess
import sys

import pytest

import mala_drake.control.solver as mut
from mala_drake.errors import BadInput


@pytest.mark.parametrize("name", ["snopt", "ipopt", "rti"])
def test_a_solver_is_made_by_its_name(problem, name):
    assert mut.MakeSolver(name, problem).name == name


def test_an_unknown_name_is_told_with_the_known_ones(problem):
    with pytest.raises(BadInput, match=r"'fmincon'.*snopt, ipopt, rti"):
        mut.MakeSolver("fmincon", problem)


def test_the_names_are_known_without_loading_any_solver():
    code = "import sys, mala_drake.control as c; print(c.SOLVER_NAMES, 'pydrake.solvers' in sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.startswith("('snopt', 'ipopt'")
    assert out.strip().endswith("False")
