from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.planning.learned_costs as mut
from mala_drake.messages import LearnedCosts, SymbolicState
from mala_drake.planning import Planner
from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.leg_costs import LegCost
from mala_drake.planning.validation import validate_plan
from mala_drake.ward.cost_parameters import CHARGE_NAMES
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()
CARE = {name: CareTask(name, WARD) for name in TASK_NAMES}
PREDICTED = CARE["medication"].planning_task.initial_state.values
SPEED = (0.50, 0.12, 0.14, 0.14, 0.10)


def observed(place="home", charge=1.0):
    atoms = [("available", item.kind, item.place) for item in all_items(WARD, ("medication",))]
    return SymbolicState(tuple(sorted([*atoms, ("at", "robot1", place)])), place, charge)


def state_with(learned, **options):
    return CARE["medication"].observed_state(
        observed(**options), (0.0, 0.0, 0.0), standing_at=options.get("place", "home"), learned=learned
    )


def test_with_nothing_learned_everything_is_as_predicted():
    assert state_with(LearnedCosts()) == CARE["medication"].planning_task.initial_state


def test_learned_costs_replace_predictions():
    way = ("nav-time", "home", "pharmacy_north")
    state = state_with(LearnedCosts(((way, 33.0), (("no-such", "fluent"), 1.0)), updates=1))
    assert state.values[way] == 33
    assert ("no-such", "fluent") not in state.values
    predicted = CARE["medication"].features(state, "(go_to_pharmacy_north robot1 home)")
    assert predicted[0] == pytest.approx(33.0 * float(PREDICTED[("feature-per-second",)]))


def test_what_was_learned_changes_the_plan():
    planner = Planner(CARE["medication"].planning_task)
    first = planner.solve(state_with(LearnedCosts()), SPEED)
    assert "(go_to_pharmacy_north robot1 home)" in first.actions
    slow = tuple((("nav-time", start, "pharmacy_north"), 300.0) for start in ("home", "supply_a", "supply_b"))
    after = planner.solve(state_with(LearnedCosts(slow, updates=1)), SPEED)
    assert any("pharmacy_south" in action for action in after.actions)


def test_a_cheaper_charge_is_a_cheaper_cost_but_no_smaller_reserve():
    way = ("home", "pharmacy_north")
    cheap = LearnedCosts(((("nav-charge", *way), 0.10), (("nav-battery", *way), 0.11)), updates=1)
    state = state_with(cheap)
    assert state.values[("nav-charge", *way)] == Fraction(1, 10)
    assert state.values[("nav-battery", *way)] == PREDICTED[("nav-battery", *way)]
    feature = CARE["medication"].features(state, "(go_to_pharmacy_north robot1 home)")[2]
    assert feature == pytest.approx(0.10 * float(PREDICTED[("feature-per-charge",)]))


def test_a_way_to_the_charger_that_takes_more_is_kept_more_charge_for():
    ways = [("supply_b", charger) for charger in ("charge_main", "charge_backup")]
    dear = LearnedCosts(tuple((("nav-battery", *way), 0.4) for way in ways), updates=1)
    values = mut.learned_fluents(PREDICTED, dear)
    assert values[("nearest-charger-battery", "supply_b")] == pytest.approx(0.4)
    assert ("nearest-charger-battery", "charge_main") not in values
    one = LearnedCosts(((("nav-battery", *ways[1]), 0.4),), updates=1)
    other = mut.learned_fluents(PREDICTED, one)[("nearest-charger-battery", "supply_b")]
    assert float(other) == pytest.approx(float(PREDICTED[("nav-battery", *ways[0])]))


numbers = st.dictionaries(
    st.sampled_from(sorted(CARE["medication"].predictions)), st.floats(0.0, 2.0), min_size=1, max_size=40
)


@given(numbers)
def test_no_charge_that_a_precondition_reads_ever_falls_below_its_prediction(values):
    known = mut.learned_fluents(PREDICTED, LearnedCosts(tuple(values.items()), updates=1))
    for name, value in known.items():
        if name[0] in CHARGE_NAMES or name[0] == "nearest-charger-battery":
            assert value >= PREDICTED[name]


@given(numbers, st.floats(0.2, 1.0))
def test_every_plan_with_learned_costs_is_a_plan_of_the_map_alone(values, charge):
    """Learning changes what is chosen, never what is allowed."""
    values = {
        name: value for name, value in values.items() if name[0] not in {*CHARGE_NAMES, "nav-charge"} or value < 0.3
    }
    learned = LearnedCosts(tuple(values.items()), updates=1)
    task = CARE["medication"].planning_task
    plan = Planner(task).solve(state_with(learned, charge=charge), SPEED)
    if plan.found:
        assert validate_plan(task, plan.actions, state=state_with(LearnedCosts(), charge=charge)).valid


def test_a_leg_from_in_transit_takes_as_much_more_as_legs_do_in_general():
    cost = LegCost(length=5.0, time=10.0, risk=0.1, charge=0.04, discomfort=2.0)
    more = mut.learned_leg(cost, LearnedCosts(leg_scales=(1.1, 1.2, 0.9, 0.5), updates=1))
    assert (more.time, more.risk, more.charge, more.discomfort) == pytest.approx((11.0, 0.12, 0.036, 1.0))


@pytest.mark.parametrize(("scale", "reserve"), [(0.5, 1.0), (2.0, 2.0)])
def test_the_reserve_of_a_leg_from_in_transit_is_never_below_its_prediction(scale, reserve):
    learned = LearnedCosts(leg_scales=(1.0, 1.0, scale, 1.0), updates=1)
    lost = SymbolicState(observed().atoms, "", 1.0)
    care = CARE["medication"]
    known, predicted = (
        care.observed_state(lost, (8.0, -10.5, 0.3), standing_at="", learned=each).values
        for each in (learned, LearnedCosts())
    )
    way = ("in_transit", "supply_b")
    for name, ratio in (("nav-charge", scale), ("nav-battery", reserve)):
        assert float(known[(name, *way)]) == pytest.approx(ratio * float(predicted[(name, *way)]), abs=2e-4)


def test_a_reserve_that_a_problem_wants_larger_than_the_way_stays_so():
    kept, way = ("nearest-charger-battery", "a"), ("nav-battery", "a", "c")
    predicted = {kept: Fraction(3, 10), ("nearest-charger-battery", "c"): Fraction(0), way: Fraction(1, 10)}
    assert mut.learned_fluents(predicted, LearnedCosts(((way, 0.2),), updates=1))[kept] == Fraction(3, 10)
    assert mut.learned_fluents(predicted, LearnedCosts(((way, 0.4),), updates=1))[kept] == pytest.approx(0.4)


def test_legs_that_take_more_in_general_are_counted_on_to_take_more():
    """A leg not driven yet: its learned mean is above its prediction, and so must be its reserve."""
    way = ("home", "supply_b")
    more = float(PREDICTED[("nav-battery", *way)]) + 0.05
    believed = LearnedCosts(
        ((("nav-charge", *way), more), (("nav-battery", *way), float(PREDICTED[("nav-battery", *way)]))), updates=1
    )
    assert mut.learned_fluents(PREDICTED, believed)[("nav-battery", *way)] == pytest.approx(more)
