import itertools
import math

import pytest

import mala_drake.robot.in_place_motions as mut
from mala_drake.robot.arm_kinematics import STOWED, STOWED_POSITION, joints_for_gripper
from mala_drake.robot.in_place_motions import Aim, Phase
from mala_drake.robot.joint_motion import JointMotion
from mala_drake.ward.in_place_actions import SECONDS, Verb
from mala_drake.ward.items import ITEM_SIZE


@pytest.mark.parametrize("verb", list(Verb))
def test_phases_follow_each_other_until_the_end(verb):
    ends = [phase.until for phase in mut.MOTIONS[verb]]
    assert ends == sorted(set(ends))
    assert ends[0] > 0.0
    assert ends[-1] == 1.0


@pytest.mark.parametrize("verb", [verb for verb in Verb if verb is not Verb.CHOOSE])
def test_every_motion_ends_with_the_arm_stowed(verb):
    assert mut.MOTIONS[verb][-1].aim is Aim.STOW


def test_a_nod_is_a_small_movement_above_the_deck():
    (nod,) = mut.MOTIONS[Verb.CHOOSE]
    target = mut.gripper_target(nod, None)
    assert 0.03 < math.dist(target, STOWED_POSITION) < 0.1
    assert target[2] > STOWED_POSITION[2]
    # There and on its way back in the time that it has, and a robot that drives off meanwhile hits nothing.
    assert JointMotion().redirected(0.0, joints_for_gripper(target)).duration < SECONDS[Verb.CHOOSE]


@pytest.mark.parametrize("verb", [Verb.COLLECT, Verb.PUT_DOWN, Verb.DELIVER, Verb.COLLECT_INGREDIENT, Verb.SERVE])
def test_boxes_are_caught_and_let_go_only_at_the_goal_and_approached_from_above(verb):
    phases = mut.MOTIONS[verb]
    changes = [i for i in range(1, len(phases)) if phases[i].holding != phases[i - 1].holding]
    assert len(changes) == 1
    assert phases[changes[0]].aim is phases[changes[0] - 1].aim is Aim.GOAL
    aims = [aim for aim, _ in itertools.groupby(phase.aim for phase in phases)]
    assert aims == [Aim.HOVER, Aim.GOAL, Aim.HOVER, Aim.STOW]


@pytest.mark.parametrize(
    ("fraction", "index"), [(0.0, 0), (0.3799, 0), (0.38, 1), (0.5, 2), (0.6, 3), (0.99, 4), (1.0, 4), (7.0, 4)]
)
def test_the_phase_is_found_by_the_fraction_of_time(fraction, index):
    assert mut.phase_index(Verb.COLLECT, fraction) == index


def test_targets_are_the_goal_or_above_it():
    goal = (0.7, 0.1, 0.9)
    assert mut.gripper_target(Phase(1.0, Aim.GOAL, True), goal) == goal
    assert mut.gripper_target(Phase(1.0, Aim.HOVER, True), goal) == pytest.approx((0.7, 0.1, 0.9 + mut.HOVER_HEIGHT))
    assert mut.gripper_target(Phase(1.0, Aim.STOW, True), goal) is None
    assert mut.gripper_target(Phase(1.0, Aim.CAMERA, True), None) == mut.CAMERA
    assert mut.gripper_target(Phase(1.0, Aim.GOAL, True, (0.1, -0.2, 0.3)), goal) == pytest.approx((0.8, -0.1, 1.2))


@pytest.mark.parametrize("aim", [Aim.GOAL, Aim.HOVER])
def test_a_goal_is_needed_to_work(aim):
    with pytest.raises(ValueError, match="goal"):
        mut.gripper_target(Phase(1.0, aim, True), None)


WORKING = [Verb.SANITIZE, Verb.WASH, Verb.CHOP, Verb.COOK, Verb.ASSEMBLE]


def test_food_is_prepared_by_moving_it_about_a_goal():
    assert [verb for verb in Verb if mut.works_about_goal(verb)] == WORKING


@pytest.mark.parametrize("verb", WORKING)
def test_food_is_kept_in_the_gripper_clear_of_the_counter(verb):
    """The ledge is at the goal's height; behind it, from 0.14 m on, the counter's deck is 0.12 m higher."""
    for phase in mut.MOTIONS[verb][:-1]:
        ahead, aside, up = phase.offset
        assert phase.holding
        assert up >= 0.04
        assert ahead < 0.05 or up >= 0.16
        assert abs(aside) <= 0.2


def test_each_kind_of_preparation_looks_different():
    assert len({mut.MOTIONS[verb] for verb in WORKING}) == len(WORKING)


def test_what_hangs_above_its_goal_passes_over_what_stands_beside_it():
    clearance = mut.HOVER_HEIGHT - ITEM_SIZE[2]
    assert clearance >= 0.02


def test_the_camera_is_within_reach():
    assert joints_for_gripper(mut.CAMERA) is not None


@pytest.mark.parametrize("verb", [Verb.COLLECT, Verb.CHECK, Verb.DELIVER, Verb.SERVE, *WORKING])
def test_the_arm_has_the_time_its_way_takes_from_a_good_stand(verb):
    """With the box straight ahead at the height of the ledge no phase but the last has to wait for the arm."""
    phases, seconds = mut.MOTIONS[verb], SECONDS[verb]
    goal, joints, begin = (0.7, 0.0, 0.90), STOWED, 0.0
    for phase in phases[:-1]:
        target = mut.gripper_target(phase, goal)
        wanted = STOWED if target is None else joints_for_gripper(target)
        motion = JointMotion(goal=joints).redirected(0.0, wanted)
        assert motion.duration <= (phase.until - begin) * seconds
        joints, begin = wanted, phase.until
