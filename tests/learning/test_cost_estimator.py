import itertools
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.learning.cost_estimator as mut
from mala_drake.errors import BadInput
from mala_drake.messages import LearnedCosts

CHECK = ("check-time",)
PLACES = ("home", "supply_a", "pharmacy_north", "charge_main")
WAYS = tuple(itertools.permutations(PLACES, 2))
PREDICTIONS = {
    CHECK: 2.2,
    **{("nav-time", *way): 10.0 + 2.0 * i for i, way in enumerate(WAYS)},
    **{("nav-charge", *way): 0.1 + 0.01 * i for i, way in enumerate(WAYS)},
    **{("nav-battery", *way): 0.1 + 0.01 * i for i, way in enumerate(WAYS)},
    **{("proximity-feature", *way): 0.0 for way in WAYS},
}
positive = st.floats(0.0, 1e3, allow_nan=False)


def learn(estimator, *observations):
    state = estimator.initial_state()
    for observed in observations:
        state = estimator.update(state, observed)
    return state


def estimate(estimator, state, name):
    return estimator.estimates(state)[estimator.names.index(name)]


@pytest.fixture(scope="module")
def estimator():
    return mut.CostEstimator(PREDICTIONS)


def test_it_starts_at_the_predictions_and_says_nothing(estimator):
    state = estimator.initial_state()
    assert dict(zip(estimator.names, estimator.estimates(state), strict=True)) == pytest.approx(PREDICTIONS)
    assert estimator.learned(state) == LearnedCosts()


@given(st.lists(positive, min_size=1, max_size=12), st.floats(0.1, 10.0))
def test_an_estimate_is_the_mean_of_measurements_and_prediction(values, weight):
    """The closed form of theta <- theta + (y - theta) / (n + n_0)."""
    estimator = mut.CostEstimator(PREDICTIONS, prediction_weight=weight, least_step=0.0)
    state = learn(estimator, *({CHECK: value} for value in values))
    expected = (weight * PREDICTIONS[CHECK] + sum(values)) / (weight + len(values))
    assert estimate(estimator, state, CHECK) == pytest.approx(expected)


@given(st.lists(positive, min_size=2, max_size=8), st.randoms(use_true_random=False))
def test_the_order_of_measurements_does_not_matter(values, random):
    estimator = mut.CostEstimator(PREDICTIONS, least_step=0.0)
    shuffled = values.copy()
    random.shuffle(shuffled)
    names = [CHECK, ("nav-time", *WAYS[0]), ("nav-charge", *WAYS[1])]
    one, other = (learn(estimator, *(dict.fromkeys(names, v) for v in each)) for each in (values, shuffled))
    assert estimator.estimates(one) == pytest.approx(estimator.estimates(other))


@given(st.lists(st.tuples(st.sampled_from(sorted(PREDICTIONS)), positive), max_size=30))
def test_estimates_stay_finite_and_never_become_negative(observations):
    estimator = mut.CostEstimator(PREDICTIONS)
    state = learn(estimator, *({name: value} for name, value in observations))
    assert np.all(np.isfinite(state))
    assert np.all(estimator.estimates(state) >= 0.0)


def test_what_some_legs_teach_is_believed_of_all_legs(estimator):
    """Every leg truly takes 1.2 times the predicted time: the more were driven, the better the rest is known."""
    unseen = ("nav-time", *WAYS[-1])
    errors = []
    for count in (0, 2, 5, 11):
        driven = [("nav-time", *way) for way in WAYS[:count]]
        state = learn(estimator, *({way: 1.2 * PREDICTIONS[way]} for way in driven for _ in range(3)))
        errors.append(1.2 * PREDICTIONS[unseen] - estimate(estimator, state, unseen))
        assert estimator.leg_scales(state)[1:] == pytest.approx(1.0)
    assert errors[0] > errors[1] > errors[2] > errors[3] > 0.0
    assert errors[3] < 0.5 * errors[0]


def test_the_ratio_is_a_least_squares_fit_drawn_to_one(estimator):
    """numpy solves the same problem: one row a leg, and five rows of typical legs as predicted."""
    generator = np.random.default_rng(1)
    ways = [("nav-charge", *WAYS[i]) for i in generator.integers(len(WAYS), size=30)]
    measured = [0.9 * PREDICTIONS[way] + 0.02 * generator.standard_normal() for way in ways]
    state = learn(estimator, *({way: value} for way, value in zip(ways, measured, strict=True)))
    rows, values = [], []
    for way in sorted(set(ways)):
        seen = [value for other, value in zip(ways, measured, strict=True) if other == way]
        root = np.sqrt(len(seen) / (len(seen) + 1.0))
        rows.append(root * PREDICTIONS[way])
        values.append(root * np.mean(seen))
    typical = np.sqrt(np.mean([value**2 for name, value in PREDICTIONS.items() if name[0] == "nav-charge"]))
    rows, values = [*rows, *[typical] * 5], [*values, *[typical] * 5]
    (ratio,), *_ = np.linalg.lstsq(np.array(rows)[:, None], np.array(values), rcond=None)
    assert 0.9 < ratio < 0.97
    assert estimator.leg_scales(state)[2] == pytest.approx(ratio)


def test_one_leg_driven_often_does_not_speak_for_all(estimator):
    way = ("nav-time", *WAYS[0])
    state = learn(estimator, *({way: 2.0 * PREDICTIONS[way]} for _ in range(200)))
    assert estimator.leg_scales(state)[0] < 1.1


def test_a_leg_that_differs_from_the_rest_is_known_for_what_it_is(estimator):
    way = ("nav-time", *WAYS[0])
    state = learn(estimator, *({way: 30.0} for _ in range(20)))
    assert estimate(estimator, state, way) == pytest.approx(30.0, rel=0.05)


def test_a_lasting_change_is_followed(estimator):
    way = ("nav-time", *WAYS[0])
    state = learn(estimator, *({way: 10.0} for _ in range(200)), *({way: 14.0} for _ in range(80)))
    assert estimate(estimator, state, way) == pytest.approx(14.0, abs=0.3)
    still = mut.CostEstimator(PREDICTIONS, least_step=0.0)
    state = learn(still, *({way: 10.0} for _ in range(200)), *({way: 14.0} for _ in range(80)))
    assert estimate(still, state, way) < 11.5


def test_the_reserve_is_the_most_that_was_measured_slowly_forgotten(estimator):
    reserve = ("nav-battery", *WAYS[0])
    state = learn(estimator, *({reserve: value} for value in (0.08, 0.13, 0.09)))
    assert 0.12 < estimate(estimator, state, reserve) <= 0.13
    state = learn(estimator, *({reserve: value} for value in (0.13, *[0.09] * 100)))
    assert estimate(estimator, state, reserve) == pytest.approx(0.09, abs=1e-3)


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_the_reserve_is_never_below_the_newest_measurement(values):
    estimator = mut.CostEstimator(PREDICTIONS)
    reserve = ("nav-battery", *WAYS[0])
    state = learn(estimator, *({reserve: value} for value in values))
    assert estimate(estimator, state, reserve) >= values[-1]


def test_what_cannot_be_used_is_left_out(estimator):
    state = learn(estimator, {("no-such", "thing"): 1.0, CHECK: float("nan")})
    assert np.array_equal(state, estimator.initial_state())
    assert estimator.updates(state) == 0


def test_actions_are_counted(estimator):
    state = learn(estimator, {CHECK: 2.0, ("nav-time", *WAYS[0]): 9.0}, {CHECK: 2.0})
    assert estimator.learned(state).updates == 2


@given(st.lists(st.tuples(st.sampled_from(sorted(PREDICTIONS)), positive), max_size=10))
def test_a_state_goes_through_json_bit_for_bit(observations):
    estimator = mut.CostEstimator(PREDICTIONS)
    state = learn(estimator, *({name: value / 3.0} for name, value in observations))
    restored = estimator.restore(json.loads(json.dumps(estimator.save(state))))
    assert restored.tobytes() == state.tobytes()


@pytest.mark.parametrize(
    ("predictions", "options", "where"),
    [
        ({CHECK: -1.0}, {}, "prediction of (check-time)"),
        ({CHECK: float("inf")}, {}, "prediction of (check-time)"),
        ({CHECK: 1.0}, {"prediction_weight": 0.0}, "prediction_weight"),
        ({CHECK: 1.0}, {"least_step": 1.5}, "least_step"),
    ],
)
def test_bad_settings_are_refused(predictions, options, where):
    with pytest.raises(BadInput) as error:
        mut.CostEstimator(predictions, **options)
    assert error.value.where == where
