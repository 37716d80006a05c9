import dataclasses

import mala_drake.planning.ways as mut
from mala_drake.ward.ward_map import Ward


def names(ward: Ward, task: str) -> set[tuple[str, str]]:
    return {(start.name, goal.name) for start, goal in mut.ways(ward, task)}


def test_a_medication_round_may_go_from_anywhere_to_anywhere(ward: Ward) -> None:
    goals = {place.name for place in mut.targets(ward, "medication")}
    assert len(goals) == 8
    assert names(ward, "medication") == {(a, b) for a in {*goals, "home"} for b in goals if a != b}


def test_a_meal_goes_one_way_through_the_kitchen(ward: Ward) -> None:
    ways = names(ward, "meal")
    assert ("pantry", "prep_station") in ways
    assert ("prep_station", "pantry") not in ways
    assert ("home", "stove") not in ways
    assert not [way for way in ways if way[1] == "home" or "pharmacy" in way[0]]


def test_chargers_can_be_reached_from_everywhere_and_lead_everywhere(ward: Ward) -> None:
    ways = names(ward, "meal")
    goals = {place.name for place in mut.targets(ward, "meal")}
    for charger in ("charge_main", "charge_backup"):
        assert {start for start, goal in ways if goal == charger} == {*goals, "home"} - {charger}
        assert {goal for start, goal in ways if start == charger} == goals - {charger}


def test_a_ward_without_a_kitchen_has_no_way_for_a_meal(ward: Ward) -> None:
    bare = dataclasses.replace(ward, places=tuple(p for p in ward.places if p.category == "home"))
    assert names(bare, "meal") == set()
