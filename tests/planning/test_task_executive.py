from dataclasses import replace

import pytest

import mala_drake.planning.task_executive as mut
from mala_drake.messages import ActionReport, Outcome, SymbolicState, Task
from mala_drake.planning.care_tasks import CareTask
from mala_drake.planning.task_progress import TaskProgress
from mala_drake.ward.ward_map import LoadWard

STOCK = (("available", "med_antibiotic", "pharmacy_north"), ("available", "supp_vitamin_d", "supply_A"))
WEIGHTS = (0.2, 0.2, 0.2, 0.2, 0.2)


@pytest.fixture(scope="module")
def executive() -> mut.TaskExecutive:
    care = CareTask("medication", LoadWard())
    return mut.TaskExecutive({"medication": care}, max_actions=60, max_expansions=200_000)


def situation(place: str, pose: tuple[float, float, float], *, charge: float = 1.0) -> mut.Situation:
    atoms = (*STOCK, ("at", "robot1", place)) if place else STOCK
    return mut.Situation(SymbolicState(tuple(sorted(atoms)), place, charge), pose, WEIGHTS)


HOME = situation("home", (0.0, 0.0, 0.0))
PHARMACY = situation("pharmacy_north", (5.0, 18.0, 1.57), charge=0.8)


def begun(executive: mut.TaskExecutive) -> TaskProgress:
    return executive.begin(TaskProgress(), Task(1, "medication", 0), HOME)


def ended(progress: TaskProgress, outcome: Outcome) -> ActionReport:
    return ActionReport(progress.action.sequence, outcome)


def test_a_progress_is_a_value_and_the_executive_keeps_nothing(executive: mut.TaskExecutive) -> None:
    first = begun(executive)
    advanced = executive.conclude(first, ended(first, Outcome.SUCCESS), PHARMACY)
    executive.conclude(advanced, ended(advanced, Outcome.NOT_THERE), PHARMACY)
    # Going on from the same value again gives the same again, whatever came in between.
    assert begun(executive) == first
    assert executive.conclude(first, ended(first, Outcome.SUCCESS), PHARMACY) == advanced


def test_searches_before_the_first_task_are_not_on_record(executive: mut.TaskExecutive) -> None:
    fresh = mut.TaskExecutive(
        {"medication": CareTask("medication", LoadWard())}, max_actions=60, max_expansions=200_000
    )
    assert fresh.solve_seconds == []
    begun(fresh)
    assert len(fresh.solve_seconds) == 1


@pytest.mark.parametrize(
    ("outcome", "seen", "standing_at"),
    [
        (Outcome.SUCCESS, PHARMACY, "pharmacy_north"),
        (Outcome.SUCCESS, situation("", (5.0, 14.0, 1.57), charge=0.8), ""),
        (Outcome.SUCCESS, situation("home", (0.0, 0.0, 0.0), charge=0.8), ""),
        (Outcome.STEP_BUDGET, PHARMACY, ""),
        (Outcome.WAYPOINT_ALLOCATION, PHARMACY, ""),
        (Outcome.SOLVER_FAILURE, PHARMACY, ""),
    ],
)
def test_the_robot_stands_where_a_leg_succeeded_and_the_grounding_agrees(
    executive: mut.TaskExecutive, outcome: Outcome, seen: mut.Situation, standing_at: str
) -> None:
    progress = begun(executive)
    assert executive.conclude(progress, ended(progress, outcome), seen).standing_at == standing_at


def test_it_stands_there_until_something_is_out_of_reach(executive: mut.TaskExecutive) -> None:
    progress = begun(executive)
    progress = executive.conclude(progress, ended(progress, Outcome.SUCCESS), PHARMACY)
    fell = executive.conclude(progress, ended(progress, Outcome.NOT_THERE), PHARMACY)
    assert (fell.standing_at, fell.action.place) == ("pharmacy_north", "pharmacy_north")
    away = executive.conclude(progress, ended(progress, Outcome.OUT_OF_REACH), PHARMACY)
    assert (away.standing_at, away.action.previous_place) == ("", "")


def test_waiting_for_a_position_ends_with_it(executive: mut.TaskExecutive) -> None:
    progress = begun(executive)
    lost = replace(PHARMACY, pose=(float("nan"), 0.0, 0.0), observed=SymbolicState(STOCK, "", 0.8))
    waiting = executive.conclude(progress, ended(progress, Outcome.INVALID_STATE), lost)
    assert (waiting.acting, waiting.waits) == (False, 1)
    assert executive.proceed(waiting, PHARMACY).acting
    assert executive.proceed(waiting, PHARMACY).waits == 0
