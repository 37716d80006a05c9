import re
from decimal import Decimal
from pathlib import Path

import pytest

import mala_drake.planning.features as mut
from mala_drake.errors import BadInput
from mala_drake.planning import PlanningTask
from mala_drake.planning.leg_costs import LegCosts
from mala_drake.resources import domains_folder
from mala_drake.ward.ward_map import Ward

DOMAIN, PROBLEM = domains_folder() / "domain_med.pddl", domains_folder() / "problem_med.pddl"

LAST_DIGIT = {
    "nav-time": 1e-2,
    "location-safety": 1e-5,
    "nav-charge": 1e-4,
    "nav-battery": 1e-4,
    "proximity-feature": 1e-3,
}


@pytest.fixture(scope="module")
def task() -> PlanningTask:
    return PlanningTask.load(DOMAIN, PROBLEM)


@pytest.fixture(scope="module")
def costs(ward: Ward) -> LegCosts:
    return LegCosts(ward)


@pytest.fixture(scope="module")
def generated(ward: Ward, costs: LegCosts) -> str:
    return mut.fill_problem(PROBLEM.read_text(), ward, "medication", costs=costs)


def numbers(text: str) -> dict[str, float]:
    return {fluent: float(value) for fluent, value in re.findall(r"\(= (\([^()]*\)) ([^()\s]+)\)", text)}


@pytest.mark.parametrize(("name", "file"), [("medication", "problem_med.pddl"), ("meal", "problem_meal.pddl")])
def test_the_problem_has_the_numbers_of_the_ward(ward: Ward, costs: LegCosts, name: str, file: str) -> None:
    """Fails when map, drive paths or features have changed: run scripts/make_domain_data.py."""
    committed = (domains_folder() / file).read_text()
    generated = mut.fill_problem(committed, ward, name, costs=costs)
    # Everything but the numbers is the same text; the last digit may differ from one mathematics library to another.
    assert re.sub(r"[\d.]+\)", ")", committed) == re.sub(r"[\d.]+\)", ")", generated)
    made = numbers(generated)
    for fluent, value in numbers(committed).items():
        unit = LAST_DIGIT.get(fluent.strip("()").split()[0], 1e-4)
        assert made[fluent] == pytest.approx(value, abs=1.1 * unit), fluent


def test_filling_a_problem_twice_changes_nothing(ward: Ward, costs: LegCosts, generated: str) -> None:
    assert mut.fill_problem(generated, ward, "medication", costs=costs) == generated


def test_a_written_problem_is_only_rewritten_when_it_differs(
    ward: Ward, costs: LegCosts, generated: str, tmp_path: Path
) -> None:
    path = tmp_path / "problem_med.pddl"
    path.write_text(generated.replace("(= (collect-time) 5.2)", "(= (collect-time) 7)"))
    assert mut.write_problem(path, ward, "medication", costs=costs)
    assert path.read_text() == generated
    assert not mut.write_problem(path, ward, "medication", costs=costs)


@pytest.mark.parametrize("text", ["(define (problem p))", ";; BEGIN generated\n(at r1 home)\n"])
def test_a_problem_without_a_generated_part_is_refused(ward: Ward, text: str) -> None:
    with pytest.raises(BadInput, match=r"p\.pddl: no generated part"):
        mut.fill_problem(text, ward, "medication", name="p.pddl")


def test_every_transition_has_a_risk_between_0_and_1(task: PlanningTask) -> None:
    risks = [value for fluent, value in task.initial_state.values.items() if fluent[0] == "location-safety"]
    assert len(risks) == 8 * 8  # Eight targets, from each of the others and from home.
    assert all(0 < risk < 1 for risk in risks)


def test_the_nearest_charger_is_the_nearest_of_both(task: PlanningTask) -> None:
    values = task.initial_state.values
    for (name, *places), needed in values.items():
        if name == "nearest-charger-battery" and places[0] not in ("charge_main", "charge_backup"):
            ways = [values[("nav-battery", places[0], charger)] for charger in ("charge_main", "charge_backup")]
            assert needed == min(ways)
    assert values[("nearest-charger-battery", "charge_main")] == 0


def test_a_place_that_no_charger_is_reachable_from_is_refused(ward: Ward, costs: LegCosts) -> None:
    with pytest.raises(BadInput, match="no way from pharmacy_north to a charger"):
        mut.place_fluents(costs, ward, "medication", {})


def test_numbers_have_few_digits_and_no_superfluous_zeros(generated: str) -> None:
    literals = re.findall(r"\(= \([^()]*\) ([^()\s]+)\)", generated)
    assert len(literals) > 250
    for literal in literals:
        assert re.fullmatch(r"\d+(\.\d{1,6})?", literal), literal
        assert str(Decimal(literal)) == literal
    begin = generated.index(";; BEGIN generated")
    assert not re.search(r"\.\d*0\)", generated[begin:])


def test_places_are_known_to_the_domain_in_lower_case(ward: Ward, task: PlanningTask) -> None:
    locations = {place.name.lower() for place in ward.places if place.category != "kitchen"} | {mut.IN_TRANSIT}
    assert set(task.description.objects_of(("location",))) == locations


def test_a_meal_is_told_what_sets_its_dishes_apart(ward: Ward) -> None:
    fluents = mut.table_fluents("meal")
    assert fluents[("choose-time",)] == Decimal("0.8")  # 0.5 s are three ticks, and the planner knows a tick later.
    assert fluents[("cook-battery",)] == Decimal("0.5")
    assert fluents[("assemble-time", "salad")] > fluents[("assemble-time", "sandwich")] == Decimal("5.2")
    errors = [fluents[("presentation-error", dish)] for dish in ("hot_meal", "salad", "sandwich")]
    assert errors == sorted(errors)
    assert ("deliver-time",) not in fluents
    assert ("serve-time",) not in mut.table_fluents("medication")


def test_the_kitchen_is_stocked_in_meals_only() -> None:
    stock = [
        re.findall(rf"\({name} (\w+) ", path.read_text())
        for name, path in (("available", PROBLEM), ("ingredient_available", domains_folder() / "problem_meal.pddl"))
    ]
    assert set(stock[1]) == {"bread", "nuts", "vegetables", "chicken"}
    assert len(stock[1]) == 4  # The vegetables in reserve are the same fact.
    assert len(stock[0]) == 12
