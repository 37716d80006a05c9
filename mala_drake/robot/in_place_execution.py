"""How an in-place action runs: from its acceptance, through the phases of its motion, to what became of it.

An action succeeds only when its physical effect is seen at its end: the box hangs at its pad, the boxes rest where they
were put, the battery is full.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from mala_drake.clock import ROUNDING, TICK
from mala_drake.messages import Action, ActionKind, ArmCommand, Message, Outcome
from mala_drake.robot.arm_kinematics import STOWED, Joints, Point, joints_for_gripper
from mala_drake.robot.arm_reach import Way, way_to_reach_all
from mala_drake.robot.gripper_geometry import PlanarPose, gripper_to_hang_at, hanging_positions, landing_positions
from mala_drake.robot.in_place_motions import MOTIONS, Aim, gripper_target, phase_index, works_about_goal
from mala_drake.robot.item_messages import HandedItem
from mala_drake.robot.put_spots import choose_spot, way_to_spots, way_to_work, work_goal
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.in_place_actions import COLLECTING, DELIVERING, SLOTS, VERBS, InPlaceAction, Verb, in_place_action
from mala_drake.ward.items import return_spots, table_spots, work_spot
from mala_drake.ward.ward_map import Ward

ITEM_TOLERANCE = 0.04
"""Metres that a box may be off its pad, or off the spot where it was put."""

CHARGER_REACH = 0.6
"""Metres from a charger's standing point within which the robot's contacts meet the charger's."""

FULL = 0.99
"""State of charge that counts as recharged."""

ARRIVED = 0.005
"""Radians that every joint of the arm may be off its target when the next phase of a motion begins.

A stretched arm is still centimetres short of its target, and fast, at three times that."""

_PATIENCE = 6.0  # Seconds that an action waits in all for an arm that has farther to go than usual.
_ANSWER_TIME = 1.0  # Seconds that a dispenser has to hand something over.
_CHARGING_TIME = 0.9  # Part of the recharging time after which the battery is full.

Held = tuple[tuple[str, int], ...]
"""(box, pad) pairs."""


@dataclass(frozen=True, slots=True)
class Senses:
    """What the executor perceives at a tick: the robot's own state and the boxes it sees."""

    time: float  # Seconds.
    base: PlanarPose  # As estimated.
    joints: Joints
    positions: Mapping[str, Point]  # Centres of the boxes in the world.
    charge: float
    handed: HandedItem


@dataclass(frozen=True, slots=True)
class Execution(Message):
    """The newest in-place action and how far it is.

    Attributes:
        action: what is done; sequence 0 before the first one.
        work: the action as the executor understands it.
        newest: sequence of the newest action of any kind.
        started: seconds.
        steps: ticks since.
        delay: seconds for which the motion has waited for the arm.
        phase: of the motion, -1 before the first one.
        handled: the boxes that the action is about.
        goal: where the gripper does its work, base frame.
        landings: where boxes at each pad come down, world frame.
        arm: the arm's target.
        held: what the magnet is to hold.
        outcome: how it ended.
        detail: why, in words.
        shortfall: world (dx, dy) by which the arm, or the charger's contacts, fell short; None if they did not.
        draw: charge taken from the battery, 1/s.
        charging: charge put into it, 1/s.
    """

    action: Action = Action()
    work: InPlaceAction | None = None
    newest: int = 0
    started: float = 0.0
    steps: int = 0
    delay: float = 0.0
    phase: int = -1
    handled: Held = ()
    goal: Point | None = None
    landings: tuple[Point, ...] = ()
    arm: ArmCommand = ArmCommand()
    held: Held = ()
    outcome: Outcome = Outcome.SUCCESS
    detail: str = ""
    shortfall: Way | None = None
    draw: float = 0.0
    charging: float = 0.0

    @property
    def running(self) -> bool:
        """Whether the action is under way."""
        return self.outcome is Outcome.RUNNING


def accept(execution: Execution, action: Action, senses: Senses, ward: Ward) -> Execution:
    """A newer action: it replaces the one that is under way, and starts if it is one in place."""
    if execution.running:
        execution = _end(execution, Outcome.CANCELLED, "a newer action has come", senses)
    if action.kind is not ActionKind.IN_PLACE:
        return replace(execution, newest=action.sequence)
    begun = Execution(
        action=action,
        work=in_place_action(action.name, action.arguments),
        newest=action.sequence,
        started=senses.time,
        held=execution.held,
        outcome=Outcome.RUNNING,
    )
    return _prepare(begun, senses, ward)


def _prepare(execution: Execution, senses: Senses, ward: Ward) -> Execution:
    """Chooses goal and rates, or ends the action at once when it cannot be done here."""
    work = execution.work
    if work is None:
        return _end(execution, Outcome.NOT_THERE, f"no motion is known for {execution.action.text}", senses)
    if not _is_finite(senses):
        return _end(execution, Outcome.INVALID_STATE, "the state of the robot is not finite", senses)
    execution = replace(execution, draw=work.charge / work.seconds)
    if work.verb is Verb.RECHARGE:
        return _prepare_recharge(execution, work, senses, ward)
    if work.verb is Verb.CHOOSE or work.verb in COLLECTING:
        return execution  # The goal of collecting follows from what the dispenser hands over.
    slots = [work.slot] if work.slot >= 0 else list(range(len(SLOTS)))
    handled = tuple((item, pad) for item, pad in execution.held if pad in slots)
    if len(handled) < len(slots):
        names = _contents(work)
        missing = [names[slot] for slot in slots if slot not in {pad for _, pad in handled}]
        return _end(execution, Outcome.NOT_THERE, f"the gripper holds no {' and no '.join(missing)}", senses)
    execution = replace(execution, handled=handled)
    if works_about_goal(work.verb):
        return _prepare_working(execution, work, senses, ward)
    putting = work.verb is Verb.PUT_DOWN or work.verb in DELIVERING
    return _prepare_putting(execution, work, senses, ward) if putting else execution


def _contents(work: InPlaceAction) -> tuple[str, ...]:
    """What an action expects at each pad, in words."""
    if work.verb not in VERBS["meal"]:
        return SLOTS
    return DISHES[work.dish].ingredients if work.dish in DISHES else ("first ingredient", "second ingredient")


def _prepare_working(execution: Execution, work: InPlaceAction, senses: Senses, ward: Ward) -> Execution:
    place = execution.action.place
    spot = work_spot(ward, place)
    if spot is None:
        return _end(execution, Outcome.OUT_OF_REACH, f"there is nothing to work on at {place!r}", senses)
    goal = gripper_to_hang_at((spot.x, spot.y, spot.z), senses.base, slot=-1)
    targets = [gripper_target(phase, goal) for phase in MOTIONS[work.verb]]
    points = [target for target in targets if target is not None]
    if any(joints_for_gripper(point) is None for point in points):
        execution = replace(execution, shortfall=_in_world(way_to_reach_all(points), senses))
        return _end(execution, Outcome.OUT_OF_REACH, f"the arm does not reach at {place!r}", senses)
    return replace(execution, goal=goal)


def _prepare_recharge(execution: Execution, work: InPlaceAction, senses: Senses, ward: Ward) -> Execution:
    charger = ward.place.get(execution.action.place)
    if charger is None or charger.category != "charger":
        return _end(execution, Outcome.OUT_OF_REACH, f"there is no charger at {execution.action.place!r}", senses)
    way = charger.x - senses.base[0], charger.y - senses.base[1]
    distance = math.hypot(*way)
    if distance > CHARGER_REACH:
        missing = 1.0 - CHARGER_REACH / distance
        execution = replace(execution, shortfall=(missing * way[0], missing * way[1]))
        return _end(execution, Outcome.OUT_OF_REACH, f"too far from {charger.name}", senses)
    return replace(execution, charging=max(0.0, 1.0 - senses.charge) / (_CHARGING_TIME * work.seconds))


def _prepare_putting(execution: Execution, work: InPlaceAction, senses: Senses, ward: Ward) -> Execution:
    place = execution.action.place
    kind = execution.handled[0][0].rpartition("/")[2]
    spots = table_spots(ward, place) if work.verb in DELIVERING else return_spots(ward, place, kind)
    if not spots:
        return _end(execution, Outcome.OUT_OF_REACH, f"there is nothing to put it on at {place!r}", senses)
    carried = {item for item, _ in execution.held}
    others = [position for item, position in senses.positions.items() if item not in carried]
    goal, reachable = choose_spot(spots, senses.base, work.slot, others)
    landings = None if goal is None else landing_positions(senses.base, goal)
    if goal is None or landings is None:
        why = "there is no room left" if reachable else "the arm does not reach"
        if not reachable:
            execution = replace(execution, shortfall=_in_world(way_to_spots(spots, senses.base, work.slot), senses))
        return _end(execution, Outcome.OUT_OF_REACH, f"{why} at {place!r}", senses)
    return replace(execution, goal=goal, landings=landings)


def advance(execution: Execution, senses: Senses) -> Execution:
    """A tick of the action that is under way."""
    work = execution.work
    if not execution.running or work is None:
        return execution
    steps = execution.steps + 1
    # An action costs what it costs, however long it has to wait for the arm.
    paid = steps * TICK + ROUNDING >= work.seconds
    execution = replace(execution, steps=steps, draw=0.0 if paid else execution.draw)
    if not _is_finite(senses):
        return _end(execution, Outcome.INVALID_STATE, "the state of the robot is not finite", senses)
    if work.verb is not Verb.RECHARGE and not senses.charge > 0.0:
        return _end(execution, Outcome.BATTERY_EMPTY, "", senses)
    if _is_waiting_for_arm(execution, work, senses):
        execution = replace(execution, delay=execution.delay + TICK)
    elapsed = senses.time - execution.started - execution.delay + ROUNDING
    if elapsed >= work.seconds:
        return _judge(execution, work, senses)
    if work.verb in COLLECTING and not execution.handled:
        if senses.handed.sequence != execution.action.sequence and elapsed < _ANSWER_TIME:
            return execution
        execution = _take(execution, work, senses)
    return _move(execution, work, senses, elapsed / work.seconds) if execution.running else execution


def _is_waiting_for_arm(execution: Execution, work: InPlaceAction, senses: Senses) -> bool:
    """Whether the present phase is due to end while the arm is still on its way; the last one does not wait."""
    phases = MOTIONS[work.verb]
    if not 0 <= execution.phase < len(phases) - 1 or execution.delay + TICK > _PATIENCE:
        return False
    elapsed = senses.time - execution.started - execution.delay + ROUNDING
    if elapsed < phases[execution.phase].until * work.seconds:
        return False
    target = STOWED if execution.arm.p_BG is None else joints_for_gripper(execution.arm.p_BG)
    return target is not None and any(
        abs(joint - wanted) > ARRIVED for joint, wanted in zip(senses.joints, target, strict=True)
    )


def _take(execution: Execution, work: InPlaceAction, senses: Senses) -> Execution:
    """Sees what the dispenser hands over, and where."""
    handed = senses.handed
    if handed.sequence != execution.action.sequence:
        return _end(execution, Outcome.NOT_THERE, "the dispenser does not answer", senses)
    if not handed.item:
        return _end(execution, Outcome.OUT_OF_STOCK, f"no {work.kind} at {execution.action.place!r}", senses)
    if work.slot in {pad for _, pad in execution.held}:
        return _end(execution, Outcome.NOT_THERE, f"the gripper's pad for {work.kind} is taken", senses)
    return _aim_at_item(replace(execution, handled=((handed.item, work.slot),)), senses)


def _aim_at_item(execution: Execution, senses: Senses) -> Execution:
    """Aims at the box where it stands now."""
    ((item, slot),) = execution.handled
    goal = work_goal(senses.positions[item], senses.base, slot)
    if goal is None:
        way = way_to_work(senses.positions[item], senses.base, slot)
        execution = replace(execution, shortfall=_in_world(way, senses))
        return _end(execution, Outcome.OUT_OF_REACH, f"the arm does not reach {item}", senses)
    return replace(execution, goal=goal)


def _move(execution: Execution, work: InPlaceAction, senses: Senses, fraction: float) -> Execution:
    """Arm and magnet of the present phase; within a phase the target stays, so that the arm gets there."""
    index = phase_index(work.verb, fraction)
    if index == execution.phase:
        return execution
    phase = MOTIONS[work.verb][index]
    if work.verb in COLLECTING and phase.aim is Aim.GOAL and not phase.holding:
        execution = _aim_at_item(execution, senses)
        if not execution.running:
            return execution
    others = tuple(pair for pair in execution.held if pair not in execution.handled)
    held = tuple(sorted((*others, *(execution.handled if phase.holding else ())), key=lambda pair: pair[1]))
    return replace(execution, phase=index, arm=ArmCommand(gripper_target(phase, execution.goal)), held=held)


def _judge(execution: Execution, work: InPlaceAction, senses: Senses) -> Execution:
    """Whether the physical effect is there."""
    if work.verb is Verb.RECHARGE:
        if senses.charge >= FULL:
            return _end(execution, Outcome.SUCCESS, "", senses)
        return _end(execution, Outcome.OUT_OF_REACH, f"charged to {senses.charge:.2f} only", senses)
    if work.verb is Verb.CHOOSE:
        return _end(execution, Outcome.SUCCESS, "", senses)
    ends_holding = MOTIONS[work.verb][-1].holding
    wanted = hanging_positions(senses.base, senses.joints) if ends_holding else execution.landings
    astray = [
        item for item, pad in execution.handled if not math.dist(senses.positions[item], wanted[pad]) <= ITEM_TOLERANCE
    ]
    if execution.handled and not astray:
        return _end(execution, Outcome.SUCCESS, "", senses)
    where = "in the gripper" if ends_holding else "where it was put"
    return _end(execution, Outcome.NOT_THERE, f"{' and '.join(astray)} not {where}", senses)


def _end(execution: Execution, outcome: Outcome, detail: str, senses: Senses) -> Execution:
    """The action is over: the arm is stowed, and the magnet lets go of what does not really hang at it."""
    held = execution.held
    if _is_finite(senses):
        hanging = hanging_positions(senses.base, senses.joints)
        held = tuple(
            (item, pad) for item, pad in held if math.dist(senses.positions[item], hanging[pad]) <= ITEM_TOLERANCE
        )
    return replace(execution, outcome=outcome, detail=detail, arm=ArmCommand(), held=held, draw=0.0, charging=0.0)


def _in_world(way: Way, senses: Senses) -> Way:
    """A way in the base frame as one in the world."""
    cosine, sine = math.cos(senses.base[2]), math.sin(senses.base[2])
    return cosine * way[0] - sine * way[1], sine * way[0] + cosine * way[1]


def _is_finite(senses: Senses) -> bool:
    return all(math.isfinite(value) for value in (*senses.base, *senses.joints))
