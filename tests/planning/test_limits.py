import pytest

import mala_drake.planning.limits as mut


def test_expansions_are_counted_and_end():
    budget = mut.Budget(max_expansions=3)
    for _ in range(3):
        budget.expand()
    with pytest.raises(mut.OutOfBudget):
        budget.expand()
    assert budget.expanded == 3


def test_time_runs_out_at_the_first_tick_after_it(clock):
    budget = mut.Budget(timeout=1.0)
    budget.tick()
    clock.now += 1.001
    with pytest.raises(mut.OutOfBudget):
        budget.tick()
    with pytest.raises(mut.OutOfBudget):
        budget.expand()


def test_without_limits_nothing_ends():
    budget = mut.Budget()
    for _ in range(10_000):
        budget.expand()
    budget.tick()
