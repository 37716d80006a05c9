"""Our validator and an external one, which shares no code with this project, agree about plans."""

import pytest

import mala_drake.planning.validation as mut
from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask
from mala_drake.resources import domains_folder

NAMES = ["blocks", "briefcase", "care", "counters", "delivery", "depots", "gripper", "hanoi", "lift", "logistics"]
NAMES += ["sailing", "zenotravel"]


@pytest.mark.parametrize("name", NAMES)
def test_an_external_validator_accepts_the_plans_at_their_cost(load, request, name):
    kairos = pytest.importorskip("kairos")
    plan = Planner(load(name)).solve()
    folder = request.path.parent.parent / "data" / "pddl"
    domain = kairos.parse_domain((folder / f"{name}-domain.pddl").read_text())
    problem = kairos.parse_problem((folder / f"{name}-problem.pddl").read_text(), domain)
    steps = "\n".join(f"{number}: {action}" for number, action in enumerate(plan.actions))
    report = kairos.validate(problem, kairos.parse_plan(steps))
    assert report.valid
    if report.metric is not None:
        assert report.metric == pytest.approx(float(plan.cost), abs=1e-9)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", ["med", "meal"])
def test_an_external_validator_accepts_what_is_done_for_a_patient(name, profile):
    kairos = pytest.importorskip("kairos")
    domain, problem = ((domains_folder() / f"{part}_{name}.pddl").read_text() for part in ("domain", "problem"))
    for i, weight in enumerate(PROFILES[profile]):
        problem = problem.replace(f"(= (w{i}) 0.2)", f"(= (w{i}) {weight})")
    plan = Planner(PlanningTask.parse(domain, problem)).solve()
    posed = kairos.parse_problem(problem, kairos.parse_domain(domain))
    report = kairos.validate(posed, kairos.parse_plan("\n".join(plan.actions)))
    assert report.valid
    assert report.metric == pytest.approx(float(plan.cost), abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_a_plan_without_its_first_or_last_action_is_not_valid(load, name):
    task = load(name)
    actions = Planner(task).solve().actions
    assert mut.validate_plan(task, actions).valid
    if name not in ("counters", "sailing"):  # There the order of equal steps does not matter, only their number.
        first = mut.validate_plan(task, actions[1:])
        assert not first.valid
        assert first.cost is None
    last = mut.validate_plan(task, actions[:-1])
    assert not last.valid
    assert "the goal does not hold" in last.reason


def test_says_which_step_fails_and_why(load):
    task = load("gripper")
    verdict = mut.validate_plan(task, ["(move here there)", "(pick b1 here left)"])
    assert verdict.reason == "step 2: (pick b1 here left): the precondition does not hold"
    assert "no such action" in mut.validate_plan(task, ["(jump)"]).reason
    assert "cannot be ?b" in mut.validate_plan(task, ["(pick left here b1)"]).reason
