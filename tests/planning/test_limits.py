import pytest

import mala_drake.planning.limits as mut


def test_expansions_are_counted_and_end():
    budget = mut.Budget(max_expansions=3)
    for _ in range(3):
        budget.expand()
    with pytest.raises(mut.OutOfBudget):
        budget.expand()
    assert budget.expanded == 3


def test_time_runs_out_during_ticks():
    budget = mut.Budget(timeout=0.0)

    def work():
        for _ in range(1000):
            budget.tick()

    with pytest.raises(mut.OutOfBudget):
        work()


def test_without_limits_nothing_ends():
    budget = mut.Budget()
    for _ in range(10_000):
        budget.expand()
    budget.check_time()
