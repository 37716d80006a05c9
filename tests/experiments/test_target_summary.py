from types import SimpleNamespace

import pytest

import mala_drake.experiments.target_summary as mut


def leg(place, mismatch, moved, distance, outcome="success"):
    return {
        "place": place,
        "outcome": outcome,
        "mismatch": mismatch,
        "moved": moved,
        "distance_to_true_m": distance,
    }


def run(*episodes):
    return [SimpleNamespace(displaced_legs=list(legs)) for legs in episodes]


def test_updates_are_counted_until_a_leg_stops_without_mismatch():
    runs = [
        run([leg("pantry", 0.5, True, 1.2)], [leg("pantry", 0.1, True, 0.4), leg("pantry", 0.0, True, 0.1)]),
        run([leg("pantry", 0.4, True, 0.3), leg("pantry", 0.0, False, 0.3)]),
    ]
    assert mut.target_figures(runs) == {
        "pantry": {
            "runs": 2,
            "found": 2,
            "median_updates": 1.5,
            "max_updates": 2,
            "median_final_distance_m": pytest.approx(0.2),
            "max_final_distance_m": 0.3,
            "sensitivities": {},  # As of a file in which legs do not tell it.
            "median_sensitivity_deviation": None,
            "max_sensitivity_deviation": None,
        }
    }


def test_it_is_counted_what_updates_went_through():
    through = [("simulated", 0.01), ("simulated", 0.04), ("fallback", 0.9), ("fallback", None), ("identity", None)]
    legs = [
        {**leg("pantry", 0.5, True, 0.3), "sensitivity": source, "sensitivity_deviation": deviation}
        for source, deviation in through
    ]
    unmoved = {**leg("pantry", 0.0, False, 0.3), "sensitivity": None, "sensitivity_deviation": None}
    figures = mut.target_figures([run([*legs, unmoved])])["pantry"]
    assert figures["sensitivities"] == {"fallback": 2, "identity": 1, "simulated": 2}
    assert (figures["median_sensitivity_deviation"], figures["max_sensitivity_deviation"]) == (0.04, 0.9)


def test_legs_that_moved_nothing_are_no_updates():
    runs = [run([leg("pantry", 0.5, False, 2.0), leg("pantry", 0.5, True, 0.2), leg("pantry", 0.0, False, 0.2)])]
    assert mut.target_figures(runs)["pantry"]["max_updates"] == 1


def test_a_place_is_not_found_while_its_legs_fail_or_miss():
    runs = [run([leg("stove", 0.5, True, 2.0), leg("stove", 0.0, False, 2.0, "blocked")])]
    figures = mut.target_figures(runs)["stove"]
    assert (figures["found"], figures["median_updates"], figures["max_updates"]) == (0, None, None)
    assert figures["max_final_distance_m"] == 2.0


def test_each_place_counts_the_runs_that_have_driven_to_it():
    runs = [run([leg("stove", 0.0, False, 0.0)]), run([leg("pantry", 0.5, False, 2.0)]), run([])]
    figures = mut.target_figures(runs)
    assert {place: each["runs"] for place, each in figures.items()} == {"pantry": 1, "stove": 1}
    assert mut.target_figures([run([])]) == {}


def test_a_mismatch_that_comes_back_was_not_gone():
    legs = [leg("stove", 0.5, True, 1.1), leg("stove", 0.0, False, 1.1), leg("stove", 0.02, True, 0.7)]
    assert mut.updates_until_gone(legs) is None
    assert mut.updates_until_gone([*legs, leg("stove", 0.0, False, 0.7)]) == 2
    assert mut.updates_until_gone([]) is None


def test_a_leg_that_was_not_driven_to_its_end_is_no_mismatch_and_finds_nothing():
    found = [leg("stove", 0.5, True, 0.7), leg("stove", 0.0, False, 0.7)]
    stuck = leg("stove", 1.0, False, 0.7, "waypoint_allocation")
    assert mut.updates_until_gone([*found, stuck]) == 1
    assert mut.updates_until_gone([*found[:1], stuck]) is None


def test_what_is_out_of_reach_is_a_mismatch():
    legs = [leg("stove", 0.0, False, 0.9), leg("stove", 0.1, True, 0.6, "out_of_reach")]
    assert mut.updates_until_gone(legs) is None
    assert mut.updates_until_gone([*legs, leg("stove", 0.0, False, 0.6)]) == 1
