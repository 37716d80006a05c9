import dataclasses

import mala_drake.experiments.bench_mpc as mut
from mala_drake.control import OptimalControlProblem
from mala_drake.experiments.model_drives import course


def test_a_row_a_solver_with_its_times_by_phase_and_its_cost_against_snopts():
    short = dataclasses.replace(course(), steps=4)
    rows = mut.bench_drives(OptimalControlProblem(), "short", [short], (0, 1), iterations=(1, 20))
    assert [row["solver"] for row in rows] == ["snopt", "rti, 1", "rti, 20"]
    assert {row["solves"] for row in rows} == {8}
    for row in rows:
        assert 0 < row["median_ms"] <= row["p95_ms"] <= row["max_ms"]
        assert row["failures"] == 0
    assert rows[0]["cost_ratio"] == 1.0
    assert rows[0]["preparation_ms"] == 0.0
    assert rows[1]["preparation_ms"] > 0.0
    assert rows[1]["feedback_ms"] < rows[1]["median_ms"]
    assert rows[1]["not_converged"] > rows[2]["not_converged"] == 0
