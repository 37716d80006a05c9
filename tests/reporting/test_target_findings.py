"""What is said of displaced targets, from results whose legs are known."""

from __future__ import annotations

from mala_drake.reporting import target_findings as mut
from mala_drake.reporting.results import load_results
from mala_drake.ward.ward_map import LoadWard

LEARNED = [[("pantry", (0.1, 0.0), 0.3, True)], [("pantry", (0.1, 0.0), 0.0, False)]]
MAPPED = [[("pantry", (0.5, -1.9), 0.3, False)]] * 2


def test_what_was_found_is_told_condition_by_condition(tmp_path, simulate_targets):
    results = load_results(simulate_targets(tmp_path, {"full": LEARNED, "outer_loop_only": MAPPED}))
    full, outer, paper = mut.target_sentences(results, LoadWard())
    assert full.startswith("Full: 2 of 2 places found, after 1 update of the target (median; at most 1); targets end")
    assert outer.startswith("Outer loop only: 0 of 2 places found; targets end 1.96 m")
    assert "13 to about 20" in paper
    found, updates, distance = mut.target_headline(results, LoadWard())
    assert (found.value, found.good, updates.value, distance.value) == ("2/2", True, "1", "0.10 m")


def test_a_place_that_was_not_found_is_no_good_news(tmp_path, simulate_targets):
    results = load_results(simulate_targets(tmp_path, {"outer_loop_only": MAPPED}))
    found, updates, _ = mut.target_headline(results, LoadWard())
    assert (found.value, found.good, updates.value) == ("0/2", False, "never")


def test_where_nothing_is_displaced_there_is_nothing_to_tell(tmp_path, simulate_results):
    results = load_results(simulate_results(tmp_path, profiles=("speed_oriented",), seeds=(0,), episodes=1))
    assert mut.target_headline(results, LoadWard()) == ()
