"""The tables of displaced targets, cell by cell, against figures counted by hand."""

from __future__ import annotations

import pytest

from mala_drake.reporting import target_tables as mut
from mala_drake.reporting.results import load_results
from mala_drake.ward.ward_map import LoadWard

PANTRY = "pantry"
LEARNED = [
    [(PANTRY, (0.0, -1.2), 0.3, True)],
    [(PANTRY, (0.1, 0.0), 0.05, True), (PANTRY, (0.1, 0.0), 0.0, False)],
    [(PANTRY, (0.1, 0.0), 0.0, False)],
]
MAPPED = [[(PANTRY, (0.5, -1.9), 0.3, False)]] * 3


def fail(record):
    """One seed fails while the place is not found; without learning all do."""
    found = any(leg["mismatch"] == 0.0 for leg in record.displaced_legs)
    record.success, record.sim_time_s, record.mismatches = found or record.seed == 1, 100.0, 2
    record.success &= bool(found or record.displaced_legs[0]["moved"])
    record.failure = None if record.success else "out of reach"
    return record


@pytest.fixture(scope="module")
def results(tmp_path_factory, simulate_targets):
    folder = tmp_path_factory.mktemp("targets")
    return load_results(simulate_targets(folder, {"full": LEARNED, "outer_loop_only": MAPPED}, change=fail))


def test_each_place_stands_beside_the_papers_figures(results):
    pantry, total = mut.target_table(results, LoadWard()).groups
    assert (pantry.title, total.title) == ("Pantry", "All")
    full = ("full", "2", "2/2", "2", "2", "1.96", "0.10 (0.10)", "3/4", "2/2")
    fixed = ("outer loop only", "2", "0/2", "never", "–", "1.96", "1.96 (1.96)", "0/6", "–")
    assert pantry.rows == (full, fixed, ("paper", "–", "–", "13–14", "–", "–", "–", "–", "–"))
    assert total.rows == (full, fixed)


def test_conditions_are_compared_as_a_whole(results):
    main, others = mut.target_condition_table(results, LoadWard()).groups
    ((name, *cells),) = main.rows
    assert (name, cells[:7]) == ("full", ["6", "83.3 %", "3/4", "2/2", "100", "0.10 (0.10)", "2.0"])
    ((name, *cells),) = others.rows
    assert (name, cells[:7]) == ("outer loop only", ["6", "0 %", "0/4", "0/2", "–", "1.96 (1.96)", "2.0"])
