import itertools

import pytest

import mala_drake.robot.in_place_motions as mut
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper
from mala_drake.robot.in_place_motions import Aim
from mala_drake.robot.joint_motion import JointMotion
from mala_drake.ward.in_place_actions import SECONDS, Verb
from mala_drake.ward.items import ITEM_SIZE


@pytest.mark.parametrize("verb", list(Verb))
def test_phases_follow_each_other_until_the_end(verb):
    ends = [phase.until for phase in mut.MOTIONS[verb]]
    assert ends == sorted(set(ends))
    assert ends[0] > 0.0
    assert ends[-1] == 1.0


@pytest.mark.parametrize("verb", list(Verb))
def test_every_motion_ends_with_the_arm_stowed(verb):
    assert mut.MOTIONS[verb][-1].aim is Aim.STOW


@pytest.mark.parametrize("verb", [Verb.COLLECT, Verb.PUT_DOWN, Verb.DELIVER])
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
    assert mut.gripper_target(Aim.GOAL, goal) == goal
    assert mut.gripper_target(Aim.HOVER, goal) == pytest.approx((0.7, 0.1, 0.9 + mut.HOVER_HEIGHT))
    assert mut.gripper_target(Aim.STOW, goal) is None
    assert mut.gripper_target(Aim.CAMERA, None) == mut.CAMERA


@pytest.mark.parametrize("aim", [Aim.GOAL, Aim.HOVER])
def test_a_goal_is_needed_to_work(aim):
    with pytest.raises(ValueError, match="goal"):
        mut.gripper_target(aim, None)


def test_what_hangs_above_its_goal_passes_over_what_stands_beside_it():
    clearance = mut.HOVER_HEIGHT - ITEM_SIZE[2]
    assert clearance >= 0.02


def test_the_camera_is_within_reach():
    assert joints_for_gripper(mut.CAMERA) is not None


@pytest.mark.parametrize("verb", [Verb.COLLECT, Verb.CHECK, Verb.DELIVER])
def test_the_arm_has_the_time_its_way_takes_from_a_good_stand(verb):
    """With the box straight ahead at the height of the ledge no phase but the last has to wait for the arm."""
    phases, seconds = mut.MOTIONS[verb], SECONDS[verb]
    goal, joints, begin = (0.7, 0.0, 0.90), STOWED, 0.0
    for phase in phases[:-1]:
        target = mut.gripper_target(phase.aim, goal)
        wanted = STOWED if target is None else joints_for_gripper(target)
        motion = JointMotion(goal=joints).redirected(0.0, wanted)
        assert motion.duration <= (phase.until - begin) * seconds
        joints, begin = wanted, phase.until
