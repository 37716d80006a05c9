import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares, lsq_linear

import mala_drake.learning.dynamics_estimator as mut
from mala_drake.clock import PLANT_STEP, TICK
from mala_drake.control.model import step_function
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.errors import BadInput

TRUTH = np.array([7.0, -0.07, 0.35, 0.94, 0.98, 0.93])
"""Another robot than the nominal one."""

NOISE = np.array([0.0, 0.0, 0.0, 3e-3, 2e-4, 3e-3])
STEP = step_function(TICK)


def next_state(state, control, dynamics=TRUTH):
    return np.array(STEP(state, control, dynamics)).ravel()


def log(samples, *, seed=0, excited=True, noise=NOISE, dynamics=TRUTH):
    """What a robot of known dynamics does: states anew for each sample, controls that excite everything, or nothing."""
    generator = np.random.default_rng(seed)
    controls = generator.uniform((0.0, 0.0, -1.0), (2.0, 1.0, 1.0), (samples, 3))
    if not excited:
        controls[:, 0], controls[:, 1:] = 1e-3, 0.0
    for control in controls:
        before = generator.uniform((-9, -9, -3, 0.5, -0.01, -0.8), (9, 9, 3, 1.4, 0.01, 0.8))
        if not excited:
            before[4:] = 0.0
        after = next_state(before, control, dynamics) + noise * generator.standard_normal(6)
        yield mut.Transition(before, control, after)


def learned(transitions, learner=None):
    learner = learner or mut.DynamicsEstimator()
    state = learner.initial_state()
    for transition in transitions:
        state = learner.update(state, transition)
    return learner, state


def test_before_any_sample_the_model_is_the_nominal_one():
    learner = mut.DynamicsEstimator()
    state = learner.initial_state()
    assert DynamicsParameters(*learner.coefficients(state)) == DynamicsParameters()
    assert learner.learned(state).updates == 0
    assert learner.deviations(state) == pytest.approx(mut.NOMINAL_DEVIATIONS)


def test_known_coefficients_are_recovered():
    learner, state = learned(log(400))
    assert learner.updates(state) > 390  # An innocent sample or two may contradict themselves.
    assert learner.coefficients(state)[2:] == pytest.approx(TRUTH[2:], rel=0.02)
    damping, coupling = learner.coefficients(state)[:2]
    assert coupling / damping == pytest.approx(TRUTH[1] / TRUTH[0], rel=0.05)


def test_without_noise_they_are_recovered_almost_exactly():
    learner, state = learned(log(300, noise=0 * NOISE))
    assert learner.coefficients(state)[2:] == pytest.approx(TRUTH[2:], rel=3e-3)
    assert learner.coefficients(state)[:2] == pytest.approx(TRUTH[:2], rel=0.03)  # The slip is nearly instantaneous.


def test_deviations_tell_how_far_the_estimate_is_off():
    errors = []
    for seed in range(12):
        learner, state = learned(log(250, seed=seed))
        errors.append((learner.coefficients(state) - TRUTH) / learner.deviations(state))
    share_within = np.mean(np.abs(errors) < 1.96)
    assert share_within > 0.88
    assert np.sqrt(np.mean(np.square(errors))) > 0.4  # And are not just large.


def test_deviations_shrink_with_the_samples():
    learner = mut.DynamicsEstimator()
    state, deviations = learner.initial_state(), []
    for transition in log(100):
        state = learner.update(state, transition)
        deviations.append(learner.deviations(state))
    assert (deviations[99] < 0.6 * deviations[9]).all()


def with_outliers(transitions, share, size):
    generator = np.random.default_rng(7)
    for t in transitions:
        blunder = generator.choice((-size, size), 3) * (generator.random() < share)
        yield mut.Transition(t.before, t.control, t.after + np.append(np.zeros(3), blunder))


def test_outliers_hardly_matter():
    learner = mut.DynamicsEstimator()
    # The pose is tolerated to be off, so that only the bounded influence is left to defend the estimate.
    tolerant = mut.DynamicsEstimator(pose_noise=1.0)
    outliers = list(with_outliers(log(500), 0.08, 0.5))
    for each in (learner, tolerant):
        _, state = learned(outliers, each)
        assert each.coefficients(state)[2:] == pytest.approx(TRUTH[2:], rel=0.10)
    plain = least_squares_of_turning(outliers)
    _, state = learned(outliers, tolerant)
    robust = learner.coefficients(state)[[5, 2]]
    assert np.abs(robust - TRUTH[[5, 2]]).sum() < 0.5 * np.abs(plain - TRUTH[[5, 2]]).sum()


def least_squares_of_turning(transitions):
    rows, values = [], []
    for t in transitions:
        mean = 0.5 * (t.before + t.after)
        rows.append((t.control[2], -mean[3] * mean[5]))
        values.append((t.after[5] - t.before[5]) / TICK)
    return np.linalg.lstsq(np.array(rows), np.array(values), rcond=None)[0]


@given(
    st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=3),
    st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=3),
)
def test_no_single_sample_moves_an_estimate_far(velocities, other_velocities):
    learner, state = LEARNED
    (sample,) = log(1, seed=5)
    for value in (velocities, other_velocities):
        after = np.append(sample.after[:3], value)
        # Only what the pose does not contradict gets as far as the filter.
        bad = mut.Transition(sample.before, sample.control, after)
        before, deviations = learner.coefficients(state), learner.deviations(state)
        state = learner.update(state, bad)
        assert (np.abs(learner.coefficients(state) - before) <= 3 * 2.6 * deviations).all()
        covariance = covariance_of(state)
        assert np.linalg.eigvalsh(covariance).min() > 0


LEARNED = learned(log(150), mut.DynamicsEstimator(pose_noise=1e7))


def covariance_of(state):
    triangle = np.zeros((6, 6))
    triangle[np.tril_indices(6)] = state[6:27]
    return triangle + np.tril(triangle, -1).T


def test_poor_excitation_changes_nothing_to_the_last_bit():
    learner, state = learned(log(150))
    after = state
    for transition in log(2000, excited=False):
        after = learner.update(after, transition)
    assert after is state


def test_straight_driving_leaves_what_turning_taught():
    learner, state = learned(log(150))
    before, deviations = learner.coefficients(state), learner.deviations(state)
    generator = np.random.default_rng(1)
    for _ in range(2000):
        control = np.array([generator.uniform(0.5, 2.0), 0.0, 0.0])
        start = np.array([0.0, 0.0, 0.0, generator.uniform(0.5, 1.4), 0.0, 0.0])
        noise = NOISE * generator.standard_normal(6)
        state = learner.update(state, mut.Transition(start, control, next_state(start, control) + noise))
    untouched = [0, 1, 2, 5]
    assert learner.coefficients(state)[untouched] == pytest.approx(before[untouched], rel=1e-3)
    assert learner.deviations(state)[untouched] == pytest.approx(deviations[untouched], rel=1e-2)
    assert learner.coefficients(state)[3] == pytest.approx(TRUTH[3], rel=0.01)


def test_a_change_is_followed():
    loaded = TRUTH * np.array([1.0, 1.0, 1.3, 0.9, 0.9, 0.9])
    learner, state = learned([*log(300), *log(900, seed=3, dynamics=loaded)])
    assert learner.coefficients(state)[2:] == pytest.approx(loaded[2:], rel=0.05)


SLIP = -0.02
"""g / k of the robots below, seconds."""


def slipping(samples, damping, *, seed=0, excited=True):
    """What a robot does whose slip has settled before each sample; unless `excited`, the controls let it settle on."""
    generator = np.random.default_rng(seed)
    dynamics = np.array([damping, SLIP * damping, 0.35 * excited, 0.94, 0.98, 0.93])
    for control in generator.uniform((0.0, 0.0, -1.0), (2.0, 1.0, 1.0), (samples, 3)):
        before = generator.uniform((-9, -9, -3, 0.5, 0.0, -0.8), (9, 9, 3, 1.4, 0.0, 0.8))
        before[4] = SLIP * before[3] * before[5]
        control = control if excited else np.array([1e-6, 0.0, 0.0])
        yield mut.Transition(
            before, control, next_state(before, control, dynamics) + NOISE * generator.standard_normal(6)
        )


@pytest.mark.parametrize(("damping", "excited"), [(13.0, True), (7.0, False)])
def test_the_slip_is_learned_whatever_becomes_of_its_damping(damping, excited):
    """Of a robot whose damping is beyond the bound, and of one that hardly tells its damping."""
    learner, state = learned(slipping(2000, damping, excited=excited))
    coefficients = learner.coefficients(state)
    assert (coefficients[0] > 10.9) == excited
    assert coefficients[1] / coefficients[0] == pytest.approx(SLIP, rel=0.05)


def test_a_damping_beyond_its_bound_leaves_the_best_coupling_to_that_bound():
    samples = list(slipping(600, 13.0))

    def errors(coupling):
        dynamics = np.array([mut._HIGHEST[0], coupling.item(), 0.35, 0.94, 0.98, 0.93])
        return [t.after[4] - next_state(t.before, t.control, dynamics)[4] for t in samples]

    best = least_squares(errors, [0.0]).x.item()
    learner, state = learned(samples)
    assert learner.coefficients(state)[:2] == pytest.approx([mut._HIGHEST[0], best], rel=0.02)


@given(st.integers(0, 1000), st.floats(0.4, 1.8), st.floats(0.4, 1.8))
def test_every_update_is_a_constrained_least_squares(seed, propulsion, brake):
    """Of what was known and the sample: straight on the model is linear, and both gains are correlated."""
    learner = mut.DynamicsEstimator(memory=1e9, bound=1e6)
    generator = np.random.default_rng(seed)
    state, truth = learner.initial_state(), TRUTH.copy()
    truth[3:5] = propulsion, brake
    gains, box = slice(3, 5), (mut._LOWEST[3:5], mut._HIGHEST[3:5])
    for _ in range(15):
        push = generator.uniform(0.5, 2.0)
        control = np.array([push, 0.3 * push + generator.uniform(0.0, 0.4), 0.0])
        before = np.array([0.0, 0.0, 0.0, generator.uniform(0.7, 1.4), 0.0, 0.0])
        after = next_state(before, control, truth)
        after[3] += 3e-3 * generator.standard_normal()
        known, whitening = state[gains], np.linalg.inv(np.linalg.cholesky(covariance_of(state)[gains, gains]))
        deviation = np.sqrt(state[27])  # Of the noise.
        rows = np.vstack((whitening, TICK / deviation * np.array([control[0], -control[1]])))
        values = np.append(whitening @ known, (after[3] - before[3]) / deviation)
        state = learner.update(state, mut.Transition(before, control, after))
        assert state[gains] == pytest.approx(lsq_linear(rows, values, box, method="bvls").x, rel=1e-6)
    assert learner.updates(state) == 15


def test_a_bound_lets_go_when_samples_speak_against_it():
    learner, state = learned(slipping(600, 13.0))
    assert learner.coefficients(state)[0] > 10.9
    for sample in slipping(300, 6.0, seed=1):
        state = learner.update(state, sample)
    damping, coupling = learner.coefficients(state)[:2]
    assert damping < 9.0
    assert coupling / damping == pytest.approx(SLIP, rel=0.05)


def transition(**changes):
    (plain,) = log(1, noise=0 * NOISE)
    values = {name: getattr(plain, name).copy() for name in ("before", "control", "after")}
    for name, entries in changes.items():
        for index, value in entries.items():
            values[name][index] = value
    return mut.Transition(**values)


@pytest.mark.parametrize(
    "changes",
    [
        {"control": {0: 0.0, 1: 2.0, 2: 0.0}},  # Parked.
        {"before": {3: 0.1}, "after": {3: 0.1}},  # The end of braking.
        {"before": {0: np.nan}},
        {"after": {5: np.inf}},
        {"control": {1: np.nan}},
        {"after": {0: 12.0}},  # Further than the speed takes it: not a period apart.
        {"after": {2: 1.0}},
    ],
)
def test_what_the_model_does_not_describe_is_left_out(changes):
    learner, state = learned(log(20))
    assert learner.describes(transition())
    assert not learner.describes(transition(**changes))
    assert learner.update(state, transition(**changes)) is state


def test_a_sample_taken_a_plant_step_late_is_left_out():
    (plain,) = log(1, noise=0 * NOISE)
    late = np.array(step_function(TICK + PLANT_STEP)(plain.before, plain.control, TRUTH)).ravel()
    learner = mut.DynamicsEstimator()
    assert learner.describes(plain)
    assert not learner.describes(mut.Transition(plain.before, plain.control, late))


def as_measured(transitions, pose_noise, velocity_noise):
    """What an estimator of the robot's state with noise makes of them."""
    generator = np.random.default_rng(3)
    noise = np.repeat((pose_noise, velocity_noise), 3)
    for t in transitions:
        before, after = (z + noise * generator.standard_normal(6) for z in (t.before, t.after))
        yield mut.Transition(before, t.control, after)


@pytest.mark.parametrize(("pose_noise", "velocity_noise"), [(0.0, 0.05), (0.01, 0.0), (0.01, 0.05), (1e-3, 0.1)])
def test_measurements_with_noise_that_is_told_contradict_themselves_hardly_ever(pose_noise, velocity_noise):
    samples = list(as_measured(log(600, noise=0 * NOISE), pose_noise, velocity_noise))
    learner = mut.DynamicsEstimator(pose_noise=pose_noise, velocity_noise=velocity_noise)
    assert np.mean([learner.describes(sample) for sample in samples]) > 0.98


def test_what_noisy_velocities_teach_is_not_selected_by_their_noise():
    samples = as_measured(log(600, noise=0 * NOISE), 0.0, 0.05)
    learner, state = learned(samples, mut.DynamicsEstimator(velocity_noise=0.05))
    assert learner.coefficients(state)[2] == pytest.approx(TRUTH[2], abs=3.0 * learner.deviations(state)[2])
    assert learner.deviations(state)[2] < 0.1


def test_slopes_are_those_of_the_models_step():
    learner = mut.DynamicsEstimator()
    (sample,) = log(1)
    predicted, slopes = learner.prediction(sample, TRUTH)
    assert predicted == pytest.approx(next_state(sample.before, sample.control), abs=1e-12)
    width = 1e-6
    for i in range(6):
        change = width * np.eye(6)[i]
        up, down = (next_state(sample.before, sample.control, TRUTH + sign * change) for sign in (1, -1))
        assert slopes[:, i] == pytest.approx((up - down)[3:] / (2 * width), abs=1e-8)


@given(st.integers(0, 1000))
def test_the_estimate_is_always_a_model(seed):
    wild = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    learner, state = learned(log(15, seed=seed, noise=wild), mut.DynamicsEstimator(pose_noise=10.0))
    DynamicsParameters(*learner.coefficients(state))  # Refuses what no controller may have.
    assert np.linalg.eigvalsh(covariance_of(state)).min() > 0


def test_a_state_survives_json_bit_for_bit():
    learner, state = learned(log(60))
    restored = learner.restore(json.loads(json.dumps(learner.save(state))))
    assert np.array_equal(restored, state)
    following = list(log(30, seed=9))
    a, b = state, restored
    for each in following:
        a, b = learner.update(a, each), learner.update(b, each)
    assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize(
    "settings",
    [
        {"period": 0.0},
        {"bound": -1.0},
        {"memory": 1.0},
        {"noise_memory": np.inf},
        {"pose_noise": np.nan},
        {"velocity_noise": -0.1},
        {"least_speed": -0.1},
        {"least_excitation": -1.0},
    ],
)
def test_settings_out_of_range_are_refused(settings):
    with pytest.raises(BadInput, match=f"dynamics {next(iter(settings))}"):
        mut.DynamicsEstimator(**settings)
