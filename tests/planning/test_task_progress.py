from mala_drake.messages import Action, ActionKind, Outcome, PlanMessage, Task, TaskReport
from mala_drake.planning import SymbolicState
from mala_drake.planning.task_progress import TaskProgress

STATE = SymbolicState(frozenset(), {})
LEG = Action(4, ActionKind.MOVE, "go_to_supply_a", ("robot1", "home"), place="supply_A", previous_place="home")


def acting() -> TaskProgress:
    progress = TaskProgress(action=Action(sequence=3), plan=PlanMessage(sequence=5)).begun(
        Task(2, "medication", 1), at="home"
    )
    progress = progress.following(PlanMessage(6, "optimal", (LEG.text,), 1.5), STATE)
    return progress.dispatching(LEG, STATE, (0.1, 0.2, 0.3, 0.0, 0.0))


def test_before_the_first_task_there_is_nothing_to_do() -> None:
    assert not TaskProgress().working
    assert not TaskProgress().acting


def test_a_task_is_begun_afresh_but_sequences_go_on() -> None:
    closing = acting().closing((("home", "supply_a"),))
    progress = closing.begun(Task(3, "medication", 2), at="supply_A")
    assert (progress.action.sequence, progress.plan.sequence) == (4, 6)
    assert progress.plan.actions == ()
    assert (progress.closed, progress.failures, progress.standing_at) == ((), (), "supply_A")
    assert progress.report == TaskReport(sequence=3)
    assert progress.working
    assert not progress.acting


def test_the_first_plans_cost_is_reported_and_later_plans_are_counted() -> None:
    progress = acting()
    assert (progress.report.plan_cost, progress.report.replans) == (1.5, 0)
    progress = progress.following(PlanMessage(7, "optimal", (), 9.0), STATE)
    assert (progress.report.plan_cost, progress.report.replans) == (1.5, 1)


def test_executed_actions_sum_up_in_the_report() -> None:
    progress = acting().executed(Outcome.BLOCKED, differing=(("at", "robot1", "supply_a"),), standing_at="supply_A")
    assert not progress.acting
    assert (progress.report.last_action, progress.report.last_outcome) == (LEG, Outcome.BLOCKED)
    assert progress.report.last_predicted == acting().features
    assert progress.report.last_differing == (("at", "robot1", "supply_a"),)
    again = progress.dispatching(LEG, STATE, (0.1, 0.0, 0.1, 0.0, 0.5))
    again = again.executed(Outcome.SUCCESS, differing=(), standing_at="")
    assert again.report.last_outcome is Outcome.SUCCESS
    assert again.report.actions == (LEG.text, LEG.text)
    assert again.report.predicted_features == (0.2, 0.2, 0.4, 0.0, 0.5)
    assert again.report.mismatches == 1
    assert again.standing_at == ""


def test_failures_are_counted_by_action() -> None:
    progress, count = acting().failed_once_more()
    assert count == 1
    other = progress.dispatching(Action(5, ActionKind.IN_PLACE, "recharge"), STATE, (0.0,) * 5)
    assert other.failed_once_more()[1] == 1
    assert progress.failed_once_more()[1] == 2


def test_ways_are_closed_once_each() -> None:
    progress = acting().closing((("home", "supply_a"), ("in_transit", "supply_a"))).closing((("home", "supply_a"),))
    assert progress.closed == (("home", "supply_a"), ("in_transit", "supply_a"))


def test_a_finished_task_says_whether_and_why_it_failed() -> None:
    done, failed = acting().finished(), acting().finished(failure="the box fell")
    assert (done.report.success, done.report.failure) == (True, "")
    assert (failed.report.success, failed.report.failure) == (False, "the box fell")
    assert done.report.finished
    assert failed.report.finished
    assert not done.working
    assert not failed.acting
