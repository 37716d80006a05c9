import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.patient as mut
from mala_drake.errors import BadInput
from mala_drake.messages import EpisodeReport, Ratings

WEIGHTS = mut.PROFILES["comfort_focused"]
FEATURES = (0.5, 0.3, 0.4, 0.6, 0.8)


def ratings_of(reports, **options):
    """What a patient says to each report in turn."""
    dut = mut.Patient(profile_weights=WEIGHTS, **options)
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    report = dut.GetInputPort("episode_report").FixValue(context, Value(EpisodeReport()))
    said = []
    for message in reports:
        report.GetMutableData().set_value(message)
        simulator.AdvanceTo(context.get_time() + 1.0)
        said.append(dut.GetOutputPort("ratings").Eval(context))
    return said


def delivered(sequence, features=FEATURES):
    return EpisodeReport(sequence, "medication", success=True, features=features)


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(mut.Patient(profile_weights=WEIGHTS))


def test_nothing_is_rated_before_an_episode_ends():
    assert ratings_of([EpisodeReport()]) == [Ratings()]


def test_a_delivered_episode_is_rated_by_its_features():
    (ratings,) = ratings_of([delivered(1)], noise=0.0)
    assert (ratings.sequence, ratings.features) == (1, FEATURES)
    assert ratings.values == pytest.approx([5 - 4 * f * w for f, w in zip(FEATURES, WEIGHTS, strict=True)])


def test_an_episode_is_rated_once_however_long_its_report_stands():
    first, again = ratings_of([delivered(1), delivered(1, features=(0.9,) * 5)])
    assert again == first


def test_a_patient_with_a_change_of_mind_rates_the_first_episodes_by_earlier_weights():
    earlier = mut.PROFILES["safety_first"]
    said = ratings_of(map(delivered, (1, 2, 3)), noise=0.0, earlier_weights=earlier, earlier_episodes=2)
    for ratings, weights in zip(said, (earlier, earlier, WEIGHTS), strict=True):
        assert ratings.values == pytest.approx([5 - 4 * f * w for f, w in zip(FEATURES, weights, strict=True)])


def test_the_change_of_mind_is_at_an_episode_of_the_run_not_of_the_process():
    earlier = mut.PROFILES["safety_first"]
    options = {"noise": 0.0, "earlier_weights": earlier, "earlier_episodes": 3}
    (first,) = ratings_of([delivered(4)], **options)
    assert first.values == pytest.approx([5 - 4 * f * w for f, w in zip(FEATURES, WEIGHTS, strict=True)])


def test_each_episode_has_noise_of_its_own():
    first, second = ratings_of([delivered(1), delivered(2)])
    assert second.sequence == 2
    assert second.values != first.values


def test_what_was_not_delivered_is_not_rated():
    (ratings,) = ratings_of([EpisodeReport(1, "medication", success=False, failure="blocked", features=FEATURES)])
    assert ratings == Ratings(1, (None,) * 5, FEATURES)


def test_a_failure_does_not_shift_the_ratings_that_follow():
    assert ratings_of([EpisodeReport(1, success=False), delivered(2)])[1] == ratings_of([delivered(1), delivered(2)])[1]


def test_a_resumed_run_hears_what_the_whole_run_would_have_heard():
    whole = ratings_of([delivered(1), delivered(2), delivered(3)], seed=4)
    assert ratings_of([delivered(3)], seed=4) == whole[2:]


def test_the_seed_decides_the_ratings():
    assert ratings_of([delivered(1)], seed=1) == ratings_of([delivered(1)], seed=1)
    assert ratings_of([delivered(1)], seed=1) != ratings_of([delivered(1)], seed=2)


def test_patients_of_one_seed_err_independently():
    errors = np.array(
        [
            np.subtract(ratings.values, [5 - 4 * f * w for f, w in zip(FEATURES, WEIGHTS, strict=True)])
            for profile in ("speed_oriented", "safety_first")
            for ratings in ratings_of([delivered(k) for k in range(1, 41)], profile=profile)
        ]
    ).reshape(2, -1)
    assert abs(np.corrcoef(errors)[0, 1]) < 0.2  # 200 pairs: the standard deviation is 0.07.


def test_clipping_and_missing_ratings_are_options():
    best = delivered(1, features=(0.0,) * 5)
    assert max(ratings_of([best], clip=True)[0].values) == 5.0
    assert ratings_of([best], missing=1.0)[0].values == (None,) * 5


@pytest.mark.parametrize(
    ("options", "where"),
    [
        ({"profile_weights": (0.5, 0.5)}, "patient.profile_weights"),
        ({"profile_weights": (0.5, 0.5, 0.5, 0.0, 0.0)}, "patient.profile_weights"),
        ({"profile_weights": WEIGHTS, "noise": -1.0}, "patient.noise"),
        ({"profile_weights": WEIGHTS, "seed": -1}, "seed"),
    ],
)
def test_bad_options_are_refused(options, where):
    with pytest.raises(BadInput) as error:
        mut.Patient(**options)
    assert error.value.where == where
