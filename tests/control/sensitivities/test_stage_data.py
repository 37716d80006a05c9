import numpy as np

import mala_drake.control.sensitivities.stage_data as mut
from mala_drake.control.layout import ParameterLayout

LAYOUT = ParameterLayout(horizon=4, slots=2)


def test_each_stage_selects_what_it_depends_on():
    data = mut.StageData(LAYOUT)
    packed = np.arange(LAYOUT.size, dtype=float)
    chosen = packed[data.sources]
    pieces = {name: packed[place] for name, place in LAYOUT.slices.items()}
    assert chosen.shape == (4, data.size)
    for k, row in enumerate(chosen):
        last = k == 3
        target = pieces["terminal.target"] if last else pieces["stage.references"].reshape(4, 6)[k + 1]
        np.testing.assert_array_equal(row[data.slices[mut.TARGET]], target)
        np.testing.assert_array_equal(
            row[data.slices[mut.WEIGHTS]], pieces["terminal.weights" if last else "stage.state_weights"]
        )
        np.testing.assert_array_equal(
            row[data.slices["constraints.speed_limits"]], pieces["constraints.speed_limits"][k]
        )
        for name in set(data.slices) & set(pieces) - {"constraints.speed_limits"}:
            np.testing.assert_array_equal(row[data.slices[name]], pieces[name], err_msg=name)


def test_all_parameters_but_the_first_reference_are_some_stage_s():
    missing = set(range(LAYOUT.size)) - set(mut.StageData(LAYOUT).sources.ravel().tolist())
    first = LAYOUT.slices["stage.references"].start
    assert missing == set(range(first, first + 6))
