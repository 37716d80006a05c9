"""The medication domain: what it offers, and its rules."""

import numpy as np
import pytest

from mala_drake.planning import Planner, PlanningTask

from .plan_steps import at, names, possible_names, with_charge

DOMAIN = "med"

MOVES = {
    f"go_to_{name}"
    for name in ("pharmacy_north", "pharmacy_south", "supply_a", "supply_b", "charge_main", "charge_backup")
} | {"approach_left_to_bed", "approach_right_to_bed"}
CARE = {f"collect_{kind}" for kind in ("med_antibiotic", "med_analgesic", "med_insulin")}
CARE |= {f"collect_{kind}" for kind in ("supp_vitamin_d", "supp_electrolyte", "supp_omega3")}
CARE |= {f"check_{what}_{verdict}" for what in ("medication", "supplement") for verdict in ("correct", "wrong")}
CARE |= {"put_down_medicine", "put_down_supplement", "recharge"}
CARE |= {"deliver_on_bedside_table_left", "deliver_on_bedside_table_right"}


def test_the_domain_has_the_23_actions_of_the_paper(task: PlanningTask) -> None:
    assert {schema.name for schema in task.description.actions} == MOVES | CARE
    assert len(MOVES | CARE) == 23


def test_every_action_is_possible_in_some_state(task: PlanningTask) -> None:
    assert possible_names(task) == MOVES | CARE


def test_the_best_plan_never_collects_a_wrong_item_on_purpose(planner: Planner) -> None:
    generator = np.random.default_rng(2)
    for weights in generator.dirichlet(np.full(5, 0.4), 15):
        chosen = names(planner.solve(weights=weights.tolist()).actions)
        collected = [name for name in chosen if name.startswith("collect")]
        assert sorted(collected) == ["collect_med_antibiotic", "collect_supp_vitamin_d"]
        assert not [name for name in chosen if "wrong" in name or "put_down" in name]


@pytest.mark.parametrize(
    ("place", "what", "noun", "wrong"),
    [
        ("pharmacy_north", "medication", "medicine", "med_analgesic"),
        ("pharmacy_south", "medication", "medicine", "med_insulin"),
        ("supply_a", "supplement", "supplement", "supp_omega3"),
        ("supply_b", "supplement", "supplement", "supp_electrolyte"),
    ],
)
def test_a_wrong_item_in_hand_is_checked_put_down_and_collected_again(
    task: PlanningTask, planner: Planner, place: str, what: str, noun: str, wrong: str
) -> None:
    state = at(task.initial_state, place, (f"has-{what}", "robot1"), (f"{what}-is", "robot1", wrong))
    actions = names(planner.solve(with_charge(state, 0.7)).actions)
    branch = [name for name in actions if name.startswith(("check", "put_down", "collect"))][:4]
    right = {"medicine": "med_antibiotic", "supplement": "supp_vitamin_d"}[noun]
    assert branch == [f"check_{what}_wrong", f"put_down_{noun}", f"collect_{right}", f"check_{what}_correct"]


def test_nothing_unchecked_or_wrong_is_delivered(task: PlanningTask) -> None:
    carrying = at(
        task.initial_state,
        "patient_bed_left",
        ("has-medication", "robot1"),
        ("medication-is", "robot1", "med_antibiotic"),
        ("has-supplement", "robot1"),
        ("supplement-is", "robot1", "supp_vitamin_d"),
    )
    conditions = [("correct-medication", "robot1"), ("correct-supplement", "robot1")]
    deliver = "(deliver_on_bedside_table_left robot1)"
    for known in ([], conditions[:1], conditions[1:]):
        assert deliver not in task.applicable(carrying.with_facts(add=known))
    delivered = task.apply(carrying.with_facts(add=conditions), deliver)
    assert task.is_goal(delivered)
    # Nothing is left in the gripper.
    assert {fact[0] for fact in delivered.facts if fact[1:2] == ("robot1",)} == {"at", "delivered"}


def test_the_check_tells_requested_from_not_requested(task: PlanningTask) -> None:
    there = at(task.initial_state, "pharmacy_north", ("has-medication", "robot1"))
    for kind, verdict in (("med_antibiotic", "correct"), ("med_analgesic", "wrong"), ("med_insulin", "wrong")):
        labelled = there.with_facts(add=[("medication-is", "robot1", kind)])
        checks = [name for name in task.applicable(labelled) if name.startswith("(check_")]
        assert checks == [f"(check_medication_{verdict} robot1 pharmacy_north {kind})"]


def test_a_low_charge_sends_the_robot_to_a_charger_first(task: PlanningTask, planner: Planner) -> None:
    actions = names(planner.solve(with_charge(task.initial_state, 0.3)).actions)
    assert "recharge" in actions
    assert "recharge" not in names(planner.solve(task.initial_state).actions)


def test_a_closed_way_is_not_taken(task: PlanningTask, planner: Planner) -> None:
    closed = [fact for fact in task.initial_state.facts if fact[0] == "open-way" and fact[2] == "pharmacy_north"]
    plan = planner.solve(task.initial_state.with_facts(remove=closed))
    assert "go_to_pharmacy_south" in names(plan.actions)


def test_what_is_out_of_stock_is_fetched_elsewhere(task: PlanningTask, planner: Planner) -> None:
    plan = planner.solve(task.initial_state.with_facts(remove=[("available", "supp_vitamin_d", "supply_a")]))
    assert "go_to_supply_b" in names(plan.actions)
    nowhere = [("available", "supp_vitamin_d", supply) for supply in ("supply_a", "supply_b")]
    assert planner.solve(task.initial_state.with_facts(remove=nowhere)).status == "unsolvable"
