import numpy as np
import pytest

import mala_drake.control.sensitivities.columns as mut
from mala_drake.control.layout import ParameterLayout
from mala_drake.errors import BadInput

COLUMNS = mut.Columns(ParameterLayout(horizon=3, slots=1))


def test_the_groups_partition_all_columns_in_order():
    np.testing.assert_array_equal(COLUMNS.of(mut.GROUPS[:3]), np.arange(COLUMNS.slices["dynamics"].stop))
    assert sorted(COLUMNS.of(mut.GROUPS)) == list(range(COLUMNS.size))
    assert COLUMNS.size == ParameterLayout(3, 1).size + 3 + 3 + 6


def test_pieces_come_in_the_order_given():
    np.testing.assert_array_equal(COLUMNS.of(["terminal.weights", "terminal.target"]), [*range(6, 12), *range(6)])
    np.testing.assert_array_equal(COLUMNS.of([mut.INITIAL_STATE]), np.arange(COLUMNS.size - 6, COLUMNS.size))
    assert COLUMNS.parameters.stop == COLUMNS.size - 6


def test_an_unknown_name_is_refused():
    with pytest.raises(BadInput, match="sensitivity: 'patience'; expected one of terminal, stage"):
        COLUMNS.of(["patience"])


def test_another_horizon_has_columns_of_its_own():
    longer = COLUMNS.of_horizon(4)
    assert longer.slices == mut.Columns(ParameterLayout(horizon=4, slots=1)).slices
    assert longer is COLUMNS.of_horizon(4)
    assert COLUMNS.of_horizon(3) is COLUMNS


def test_the_groups_of_pieces():
    assert COLUMNS.groups(["terminal.target", "terminal.weights", "inputs"]) == {"terminal", "inputs"}
    with pytest.raises(BadInput, match="patience"):
        COLUMNS.groups(["patience"])
