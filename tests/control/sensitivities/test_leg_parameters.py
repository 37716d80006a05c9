import numpy as np

import mala_drake.control.sensitivities.leg_parameters as mut
from mala_drake.control.sensitivities import Columns


def test_constant_parameters_have_entries_of_p_as_knobs(small, choose):
    columns, chosen = Columns(small.layout), choose()
    leg = mut.ConstantParameters(chosen, columns, ("terminal.target", "dynamics"))
    assert leg.knobs == 12
    assert leg.groups == ("terminal.target", "dynamics")
    step = leg.at(7, np.zeros(6))
    assert step.parameters is chosen
    assert step.by_state is None
    rows, knobs = np.nonzero(step.by_knobs)
    np.testing.assert_array_equal(rows, columns.of(["terminal.target", "dynamics"]))
    np.testing.assert_array_equal(knobs, np.arange(12))
    assert step.by_knobs.shape == (columns.parameters.stop, 12)


def test_all_five_groups_are_knobs_if_none_is_chosen(small, choose):
    columns = Columns(small.layout)
    assert mut.ConstantParameters(choose(), columns).knobs == columns.size - 6


def test_a_schedule_goes_by_the_number_of_the_step_and_ends_with_its_last(small, choose):
    steps = [mut.StepParameters(choose(), np.full((Columns(small.layout).parameters.stop, 2), i)) for i in range(3)]
    leg = mut.ScheduledParameters(steps, ["terminal"])
    assert (leg.knobs, leg.groups) == (2, ("terminal",))
    assert [leg.at(i, np.full(6, np.nan)) for i in range(5)] == [*steps, steps[-1], steps[-1]]
