from __future__ import annotations

import numpy as np

import mala_drake.experiments.bench_sensitivities as mut
from mala_drake.control.sensitivities.recorded_leg import RecordedLeg


def test_rows_have_times_and_the_errors_they_claim(monkeypatch):
    record = mut.record_leg

    def beginning(*arguments):
        leg = record(*arguments)
        return RecordedLeg(leg.initial_state, leg.steps[:12], leg.shares[:12])

    monkeypatch.setattr(mut, "record_leg", beginning)
    rows = mut.bench_sensitivities(solver="rti", every=12)
    assert all(list(row) == list(rows[0]) for row in rows)
    by_name = {row["computation"]: row for row in rows}
    assert by_name[mut.SOLVE]["over_solve"] == 1.0
    assert by_name["policy, all groups"]["count"] == 12
    assert float(by_name["differences, polished solves"]["median_error"]) < 1e-5
    assert float(by_name["leg, adjoint"]["median_error"]) < 1e-8
    assert float(by_name["leg, differences in 4 knobs"]["median_error"]) < 1e-5


def test_errors_are_relative_to_the_largest_entry_and_medians_over_the_solve():
    table = mut._Table()
    for name, times in ((mut.SOLVE, (2.0, 4.0, 3.0)), ("other", (6.0,))):
        table.milliseconds[name] = list(times)
    table.compare("other", np.array([[1.0, 2.1]]), np.array([[1.0, 2.0]]))
    first, second = table.rows()
    assert (first["median_ms"], first["over_solve"], first["median_error"]) == (3.0, 1.0, "")
    assert (second["over_solve"], second["median_error"]) == (2.0, "5.0e-02")
