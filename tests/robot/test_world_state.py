import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import mala_drake.robot.world_state as mut
from mala_drake.messages import Action, ActionKind, MagnetCommand, Outcome, Task
from mala_drake.robot.established_atoms import established_atoms
from mala_drake.robot.item_messages import HandedItem
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

REQUESTED = ("med_antibiotic", "supp_vitamin_d")
RIGHT, WRONG = "pharmacy_north/med_antibiotic", "pharmacy_north/med_analgesic"
PADS = ((50.0, 0.0, 1.0), (50.0, 0.14, 1.0))


@pytest.fixture(scope="module")
def items():
    return all_items(LoadWard(), ("medication",))


@pytest.fixture
def by_name(items):
    return {item.name: item for item in items}


@pytest.fixture
def shelved(items):
    """All boxes where they belong."""
    return {item.name: (item.shelf_pose.x, item.shelf_pose.y, item.shelf_pose.z) for item in items}


@pytest.fixture
def full(items):
    return mut.WorldState(stock=tuple(item.name for item in items))


def in_place(sequence, name, place="pharmacy_north"):
    return Action(sequence, ActionKind.IN_PLACE, name, ("robot1",), place, place)


def choose(state, items, *, kind="med_antibiotic", place="pharmacy_north", seed=0, wrong_probability=0.0):
    generator = np.random.default_rng(seed)
    return mut.choose_item(state, items, kind, place, generator, wrong_probability=wrong_probability)


def atoms(state, items):
    by_name = {item.name: item for item in items}
    return [atom for atom in established_atoms(state, by_name, robot="robot1") if atom[0] != "available"]


def collected(state, by_name, item, *, asked="med_antibiotic"):
    """`state` after a collect action for `asked` that really brought `item`."""
    state = mut.begin_action(state, in_place(1, f"collect_{asked}"), by_name[item])
    state = mut.follow_magnet(state, MagnetCommand(((item, 0),)), {item: PADS[0]}, PADS)
    return mut.conclude(state, Outcome.SUCCESS, by_name, REQUESTED, on_table=())


def checked(state, by_name, verdict, outcome=Outcome.SUCCESS):
    state = mut.begin_action(state, in_place(2, f"check_medication_{verdict}"), None)
    return mut.conclude(state, outcome, by_name, REQUESTED, on_table=())


def test_a_dispenser_hands_over_what_is_asked_for(full, items):
    for item in items:
        assert choose(full, items, kind=item.kind, place=item.place) == item


def test_a_dispenser_has_nothing_that_is_not_kept_there_or_was_taken(full, items):
    assert choose(full, items, kind="med_antibiotic", place="supply_A") is None
    assert choose(full, items, kind="med_antibiotic", place="") is None
    emptied = replace(full, stock=tuple(name for name in full.stock if name != RIGHT))
    assert choose(emptied, items) is None
    assert choose(emptied, items, place="pharmacy_south") is not None


def test_ingredients_are_what_they_look_like_and_the_first_of_a_kind_is_taken():
    kept = all_items(LoadWard(), ("meal",))
    state = mut.WorldState(stock=tuple(item.name for item in kept), mistakes=("med_insulin",))
    for seed in range(20):
        taken = choose(state, kept, kind="vegetables", place="pantry", seed=seed, wrong_probability=1.0)
        assert taken.name == "pantry/vegetables"
    emptied = replace(state, stock=tuple(name for name in state.stock if name != "pantry/vegetables"))
    assert choose(emptied, kept, kind="vegetables", place="pantry").name == "pantry/vegetables_2"
    assert choose(emptied, kept, kind="chicken", place="pantry") is None


def test_wrong_items_come_about_as_often_as_they_should(full, items):
    draws = 2000
    found = Counter(choose(full, items, seed=seed, wrong_probability=0.2).kind for seed in range(draws))
    wrong = found["med_analgesic"] + found["med_insulin"]
    assert wrong == pytest.approx(0.2 * draws, abs=4 * math.sqrt(0.2 * 0.8 * draws))
    assert found["med_analgesic"] == pytest.approx(wrong / 2, abs=4 * math.sqrt(wrong / 4))


def test_a_dispenser_without_another_kind_cannot_go_wrong(full, items):
    last = replace(full, stock=(RIGHT,))
    assert choose(last, items, wrong_probability=1.0).name == RIGHT


def test_mistakes_to_be_made_are_made_once_by_the_first_dispenser_that_can(full, items):
    state = mut.begin_task(full, Task(1, "medication"), ("supp_omega3", "med_insulin"))
    handed = choose(state, items)
    assert handed.kind == "med_insulin"
    state = mut.begin_action(state, in_place(1, "collect_med_antibiotic"), handed)
    assert state.mistakes == ("supp_omega3",)
    assert choose(state, items).kind == "med_antibiotic"
    assert choose(state, items, kind="supp_vitamin_d", place="supply_B").kind == "supp_omega3"


def test_a_new_task_makes_the_mistakes_again_and_has_nothing_delivered(full):
    state = replace(full, delivered=True, hand_overs=3)
    again = mut.begin_task(state, Task(2, "medication", 7), ("med_insulin",))
    assert (again.delivered, again.hand_overs, again.mistakes) == (False, 0, ("med_insulin",))
    assert again.stock == full.stock


def test_the_hand_over_names_the_box_really_handed_over(full, by_name):
    state = mut.begin_action(full, in_place(4, "collect_med_antibiotic"), by_name[WRONG])
    assert state.handed == HandedItem(4, WRONG, by_name[WRONG].shelf_pose)
    assert mut.begin_action(full, in_place(4, "collect_med_antibiotic"), None).handed == HandedItem(4)


def test_a_box_leaves_its_dispenser_when_the_magnet_wants_it(full, shelved):
    state = mut.follow_magnet(full, MagnetCommand(((RIGHT, 0),)), shelved, PADS)
    assert RIGHT not in state.stock
    assert len(state.stock) == len(full.stock) - 1
    assert state.carried[0].item == ""


def test_a_box_is_carried_only_while_it_hangs_at_its_pad(full, shelved):
    wanted = MagnetCommand(((RIGHT, 0),))
    held = mut.follow_magnet(full, wanted, shelved | {RIGHT: PADS[0]}, PADS)
    assert held.carried[0].item == RIGHT
    for position in (PADS[1], (50.0, 0.0, 0.8), (math.nan, 0.0, 1.0)):
        assert mut.follow_magnet(held, wanted, shelved | {RIGHT: position}, PADS).carried[0].item == ""
    assert mut.follow_magnet(held, MagnetCommand(), shelved | {RIGHT: PADS[0]}, PADS).carried[0].item == ""


def test_nothing_new_is_the_same_object(full, shelved):
    assert mut.follow_magnet(full, MagnetCommand(), shelved, PADS) is full


def test_the_robot_believes_the_label_it_asked_for(full, items, by_name):
    state = collected(full, by_name, WRONG)
    assert atoms(state, items) == [("has-medication", "robot1"), ("medication-is", "robot1", "med_antibiotic")]


def test_nothing_is_believed_of_a_box_that_is_not_there(full, items, by_name, shelved):
    state = mut.begin_action(full, in_place(1, "collect_med_antibiotic"), by_name[RIGHT])
    state = mut.follow_magnet(state, MagnetCommand(((RIGHT, 0),)), shelved, PADS)
    state = mut.conclude(state, Outcome.SUCCESS, by_name, REQUESTED, on_table=())
    assert atoms(state, items) == []
    assert state.concluded == 1


def test_before_the_collect_action_has_ended_nothing_is_established(full, items, by_name):
    state = mut.begin_action(full, in_place(1, "collect_med_antibiotic"), by_name[RIGHT])
    state = mut.follow_magnet(state, MagnetCommand(((RIGHT, 0),)), {RIGHT: PADS[0]}, PADS)
    assert state.carried[0].item == RIGHT
    assert atoms(state, items) == []


@pytest.mark.parametrize(
    ("item", "verdict", "found"),
    [
        (RIGHT, "correct", {("medication-is", "robot1", "med_antibiotic"), ("correct-medication", "robot1")}),
        (RIGHT, "wrong", {("medication-is", "robot1", "med_antibiotic")}),
        (WRONG, "correct", {("medication-is", "robot1", "med_analgesic")}),
        (WRONG, "wrong", {("medication-is", "robot1", "med_analgesic"), ("wrong-medication", "robot1")}),
    ],
)
def test_a_check_establishes_the_true_label_and_only_a_true_verdict(full, items, by_name, item, verdict, found):
    state = checked(collected(full, by_name, item), by_name, verdict)
    assert set(atoms(state, items)) == {("has-medication", "robot1"), *found}


def test_an_unfinished_check_establishes_nothing(full, items, by_name):
    before = collected(full, by_name, WRONG)
    assert atoms(checked(before, by_name, "wrong", Outcome.CANCELLED), items) == atoms(before, items)


def test_a_box_put_down_is_forgotten_with_all_that_was_known_of_it(full, items, by_name, shelved):
    state = checked(checked(collected(full, by_name, WRONG), by_name, "correct"), by_name, "wrong")
    state = mut.begin_action(state, in_place(3, "put_down_medicine"), None)
    state = mut.follow_magnet(state, MagnetCommand(), shelved, PADS)
    state = mut.conclude(state, Outcome.SUCCESS, by_name, REQUESTED, on_table=())
    assert atoms(state, items) == []


def test_delivered_is_only_what_rests_on_the_table_all_of_it(full, items, by_name):
    deliver = in_place(5, "deliver_on_bedside_table_left", "patient_bed_left")
    for on_table, expected in (((True, True), [("delivered", "robot1")]), ((True, False), []), ((False, True), [])):
        state = mut.begin_action(full, deliver, None)
        state = mut.conclude(state, Outcome.SUCCESS, by_name, REQUESTED, on_table=on_table)
        assert atoms(state, items) == expected


def test_a_box_that_the_gripper_missed_is_kept_again(full, items, shelved):
    missed = replace(full, stock=tuple(name for name in full.stock if name != RIGHT))
    assert mut.take_back(missed, items, MagnetCommand(), shelved) == full
    assert mut.take_back(missed, items, MagnetCommand(((RIGHT, 0),)), shelved) is missed
    fallen = shelved | {RIGHT: (5.0, 18.2, 0.05)}
    assert mut.take_back(missed, items, MagnetCommand(), fallen) is missed


def test_a_leg_is_no_in_place_action():
    assert mut.read_action(Action(1, ActionKind.MOVE, "recharge")) is None
    assert mut.read_action(in_place(1, "recharge")) is not None
