import numpy as np
import pytest

import mala_drake.experiments.model_drive as mut
from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.experiments.model_drives import course, ward_leg
from mala_drake.ward.ward_map import LoadWard


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


@pytest.mark.parametrize("name", ["snopt", "rti"])
def test_the_course_is_driven_to_its_end_without_contact(problem, name):
    run = mut.run_drive(problem, MakeSolver(name, problem), course())
    assert all(sample.solution.success for sample in run.samples)
    assert run.min_clearance > 0.05
    assert run.position_error < 0.15
    assert len(run.milliseconds) == len(run.samples) == course().steps


def test_a_path_that_turns_back_just_before_its_end_is_driven_to_its_end(problem):
    leg = ward_leg(LoadWard(), "patient_bed_right", "pharmacy_south")
    run = mut.run_drive(problem, MakeSolver("rti", problem), leg, seed=1)
    assert run.min_clearance > 0.05
    assert run.position_error < 0.15


def test_in_two_phases_one_iteration_drives_it_as_well(problem):
    run = mut.run_drive_in_phases(problem, MakeSolver("rti", problem, sqp_iterations=1), course())
    whole = mut.run_drive(problem, MakeSolver("rti", problem), course())
    assert run.min_clearance > 0.05
    assert run.position_error < 0.15
    assert run.cost == pytest.approx(whole.cost, rel=0.05)
    assert len(run.preparation) == len(run.feedback)
    np.testing.assert_allclose(run.milliseconds, np.add(run.preparation, run.feedback))


def test_equal_seeds_drive_equally_and_others_do_not(problem):
    solver = MakeSolver("rti", problem)
    first, again, other = (mut.run_drive(problem, solver, course(), seed=seed) for seed in (1, 1, 2))
    assert first.cost == again.cost
    assert first.samples[-1].state.tobytes() == again.samples[-1].state.tobytes()
    assert first.cost != other.cost


def test_the_cost_is_that_of_the_steps_that_were_driven(problem):
    run = mut.run_drive(problem, MakeSolver("rti", problem), course())
    total = 0.0
    for sample in run.samples:
        error = sample.state - sample.parameters.stage.references[0]
        error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
        total += sample.parameters.stage.state_weights @ error**2
        total += sample.parameters.stage.control_weights @ sample.solution.controls[0] ** 2
    assert run.cost == pytest.approx(total)
