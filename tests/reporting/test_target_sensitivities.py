"""What updates of targets went through, counted by hand."""

from __future__ import annotations

import pytest

from mala_drake.reporting import target_sensitivities as mut
from mala_drake.reporting.report import write_report
from mala_drake.reporting.results import load_results

NEAR, FAR = (0.1, 0.0), (0.2, 0.0)
LEGS = [[("pantry", NEAR, 0.3, True)], [("pantry", NEAR, 0.2, True), ("pantry", NEAR, 0.0, False)]]
OTHERS = [[("pantry", FAR, 0.3, True)], [("pantry", FAR, 0.0, False)]]


def tell(record):
    """Legs that moved their target tell through what: by the episode, or by the identity if the target is far off."""
    for leg in record.displaced_legs:
        told = (
            ("identity", None)
            if leg["distance_to_true_m"] > 0.15
            else [("simulated", 0.01), ("fallback", 0.8)][record.episode]
        )
        leg["sensitivity"], leg["sensitivity_deviation"] = told if leg["moved"] else (None, None)
    return record


@pytest.fixture(scope="module")
def folder(tmp_path_factory, simulate_targets):
    return simulate_targets(tmp_path_factory.mktemp("targets"), {"full": LEGS, "identity": OTHERS}, change=tell)


def test_updates_are_counted_by_what_they_went_through(folder):
    (table,) = mut.sensitivity_table(load_results(folder))
    rows = {row[0]: row[1:] for group in table.groups for row in group.rows}
    assert rows == {
        "full": ("4", "2", "2", "0", "0", "0.405 (0.800)"),
        "identity": ("2", "0", "0", "2", "0", "–"),
    }


def test_the_main_condition_is_told_in_a_sentence(folder):
    (sentence,) = mut.sensitivity_sentences(load_results(folder))
    assert sentence.startswith("Of 4 updates, 2 went through the simulated sensitivity")
    assert "2 fell back to the identity; what was simulated differed from the identity by 0.800 at most" in sentence


def test_it_is_in_the_report(folder, tmp_path):
    page, *others = write_report(folder, tmp_path)
    assert "target_sensitivities.md" in {path.name for path in others}
    assert "2 fell back to the identity" in page.read_text()


def test_results_that_do_not_tell_it_are_reported_without_it(tmp_path, simulate_targets):
    results = load_results(simulate_targets(tmp_path, {"full": LEGS}))
    assert mut.sensitivity_table(results) == ()
    assert mut.sensitivity_sentences(results) == ()
