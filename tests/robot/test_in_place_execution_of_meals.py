"""What is done in place with the ingredients of a meal."""

import pytest

from mala_drake.messages import ArmCommand, Outcome

from .puppet import Puppet


class Cook(Puppet):
    """An ideal robot with the ingredients of a salad in its gripper."""

    def __init__(self, ward):
        super().__init__(ward)
        self.stand_at("pantry")
        for kind in ("nuts", "vegetables"):
            outcome = self.do("collect_ingredient", "pantry", f"pantry/{kind}", arguments=("pantry", kind))
            assert outcome is Outcome.SUCCESS

    def heights(self, name, place, arguments=("salad",)):
        """The heights of the gripper while an action is done."""
        self.stand_at(place)
        self.begin(name, place, arguments=arguments)
        found = []
        while self.tick().running:
            found.append(0.95 if self.execution.arm.p_BG is None else self.execution.arm.p_BG[2])
        assert self.execution.outcome is Outcome.SUCCESS
        return found


@pytest.fixture
def cook(ward):
    return Cook(ward)


PREPARATION = {
    "check_ingredients": ("prep_station", 4.0, 0.01),
    "sanitize_workspace": ("prep_station", 5.0, 0.02),
    "wash_ingredients": ("prep_station", 6.0, 0.02),
    "chop_ingredients": ("prep_station", 8.0, 0.03),
    "cook_meal": ("stove", 12.0, 0.50),
    "check_cooking_level": ("stove", 4.0, 0.01),
    "check_palatability": ("quality_check", 4.0, 0.01),
    "assemble": ("quality_check", 13.4, 0.02),
    "deliver_on_bedside_table_left": ("patient_bed_left", 10.0, 0.01),
}


@pytest.mark.parametrize("name", PREPARATION)
def test_what_is_done_to_a_meal_takes_its_time_and_its_charge(cook, name):
    place, seconds, used = PREPARATION[name]
    cook.stand_at(place)
    time, charge = cook.time, cook.charge
    assert cook.do(name, place, arguments=("salad",)) is Outcome.SUCCESS
    assert cook.time - time == pytest.approx(seconds)
    assert charge - cook.charge == pytest.approx(used)
    assert cook.execution.arm == ArmCommand()


@pytest.mark.parametrize("name", [name for name in PREPARATION if name != "deliver_on_bedside_table_left"])
def test_a_meal_that_slips_on_the_way_through_the_kitchen_is_not_prepared(cook, name):
    place = PREPARATION[name][0]
    cook.stand_at(place)
    cook.begin(name, place, arguments=("salad",))
    cook.slippery = {"pantry/vegetables"}
    cook.positions["pantry/vegetables"] = (*cook.base[:2], 0.05)
    assert cook.finish() is Outcome.NOT_THERE
    assert "pantry/vegetables" in cook.execution.detail
    assert cook.execution.held == (("pantry/nuts", 0),)


@pytest.mark.parametrize("name", PREPARATION)
def test_half_a_meal_is_not_worked_on(ward, name):
    cook = Puppet(ward)
    cook.stand_at("pantry")
    cook.do("collect_ingredient", "pantry", "pantry/vegetables", arguments=("pantry", "vegetables"))
    cook.stand_at(PREPARATION[name][0])
    assert cook.do(name, PREPARATION[name][0], arguments=("salad",)) is Outcome.NOT_THERE
    assert "no nuts" in cook.execution.detail
    assert cook.execution.held == (("pantry/vegetables", 1),)


@pytest.mark.parametrize(
    "name", ["sanitize_workspace", "wash_ingredients", "chop_ingredients", "cook_meal", "assemble"]
)
@pytest.mark.parametrize("place", ["home", "supply_A", "prep_station"])
def test_a_meal_is_prepared_at_its_counter_only(cook, name, place):
    cook.stand_at("home")
    assert cook.do(name, place, arguments=("salad",)) is Outcome.OUT_OF_REACH
    assert cook.execution.detail


def test_food_is_wiped_dipped_chopped_and_held_over_the_stove(cook):
    """The height of the gripper tells one action from the other."""

    def strokes(heights):
        low = [height < 1.0 for height in heights]
        return sum(now and not before for before, now in zip([False, *low], low, strict=False))

    ledge = 0.90  # Of a gripper whose boxes stand on the ledge.
    wash, chop = cook.heights("wash_ingredients", "prep_station"), cook.heights("chop_ingredients", "prep_station")
    assert strokes(wash) == 2  # The arm is stowed from the second dip.
    assert strokes(chop) == 3 + 1  # And once more when it is stowed.
    held_over = cook.heights("cook_meal", "stove")
    assert sum(height > ledge + 0.15 for height in held_over) > 0.7 * len(held_over)
    assert min(cook.heights("sanitize_workspace", "prep_station")) == pytest.approx(0.95)


def test_a_choice_is_a_nod_with_whatever_is_in_the_gripper(cook):
    cook.stand_at("home")
    time = cook.time
    cook.begin("choose_sandwich", "home")
    cook.tick()
    assert cook.execution.arm.p_BG is not None
    assert cook.finish() is Outcome.SUCCESS
    assert cook.time - time == pytest.approx(0.6)  # Half a second, to the next tick.
    assert cook.execution.held == (("pantry/nuts", 0), ("pantry/vegetables", 1))


def test_a_kind_whose_pad_is_taken_is_not_collected(cook):
    cook.stand_at("pantry")
    outcome = cook.do("collect_ingredient", "pantry", "pantry/vegetables_2", arguments=("pantry", "vegetables"))
    assert outcome is Outcome.NOT_THERE
    assert cook.execution.held == (("pantry/nuts", 0), ("pantry/vegetables", 1))
