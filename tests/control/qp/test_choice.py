import pytest

import mala_drake.control.qp.choice as mut
from mala_drake.errors import BadInput


@pytest.mark.parametrize("name", ["daqp", "clarabel", "osqp"])
def test_a_qp_solver_is_made_by_its_name(name):
    assert mut.MakeQpSolver(name).name == name


def test_an_unknown_name_is_told_with_the_known_ones():
    with pytest.raises(BadInput, match=r"'qpoases'.*daqp, clarabel, osqp"):
        mut.MakeQpSolver("qpoases")
