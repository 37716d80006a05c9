"""The simulated patient, who rates what was delivered."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem, State

from mala_drake.clock import PATIENT_OFFSET, TICK
from mala_drake.messages import EpisodeReport, Ratings
from mala_drake.patient.rating import RatingHabits, rate
from mala_drake.preferences import CRITERIA, validated_weights
from mala_drake.randomness import keyed_generator


class Patient(LeafSystem):
    """Rates each episode once, from the features that were measured.

    .. pydrake_system::

        name: Patient
        input_ports:
        - episode_report
        output_ports:
        - ratings

    The ratings carry the sequence number of the episode they are about and its features, so that a learner needs no
    other input. A patient rates what was delivered: of a failed episode every rating is None, and learners skip it.

    A patient may have a change of mind: the first episodes are rated by earlier weights. Patients of different profiles
    do not share their luck: under one seed their ratings err independently.
    """

    def __init__(
        self,
        *,
        profile_weights: Sequence[float],
        noise: float = 0.1,
        clip: bool = False,
        missing: float = 0.0,
        earlier_weights: Sequence[float] = (),
        earlier_episodes: int = 0,
        profile: str = "custom",
        seed: int = 0,
    ) -> None:
        """Constructs the patient.

        Args:
            profile_weights: the true weights w*, five on the simplex.
            noise: standard deviation of the ratings.
            clip: whether ratings are cut to [1, 5].
            missing: probability that a criterion is left unrated.
            earlier_weights: the true weights of the first episodes, like `profile_weights`; empty when there are none.
            earlier_episodes: the number of the first episode that is rated by `profile_weights`.
            profile: what the patient is called; the random numbers are its own.
            seed: of the run.

        Raises:
            BadInput: if the weights are off the simplex or a number is out of its range.
        """
        super().__init__()
        self._weights = validated_weights(profile_weights, where="patient.profile_weights")
        self._earlier_episodes = earlier_episodes
        self._earlier = validated_weights(earlier_weights or profile_weights, where="patient.earlier_weights")
        self._habits = RatingHabits(noise=noise, clip=clip, missing=missing)
        self._seed = seed
        self._stream = f"patient/{profile}"
        keyed_generator(seed, 0, self._stream)  # Refuses a bad seed now rather than in the simulation.
        self._report = self.DeclareAbstractInputPort("episode_report", Value(EpisodeReport()))
        self._ratings = self.DeclareAbstractState(Value(Ratings()))
        self.DeclareAbstractOutputPort(
            "ratings",
            lambda: Value(Ratings()),
            self._calc_ratings,
            prerequisites_of_calc={self.abstract_state_ticket(self._ratings)},
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, PATIENT_OFFSET, self._update)

    def _calc_ratings(self, context: Context, output: Value) -> None:
        output.set_value(context.get_abstract_state(self._ratings).get_value())

    def _update(self, context: Context, state: State) -> None:
        report = self._report.Eval(context)
        if report.sequence > context.get_abstract_state(self._ratings).get_value().sequence:
            state.get_mutable_abstract_state(self._ratings).set_value(self._rate(report))

    def _rate(self, report: EpisodeReport) -> Ratings:
        if not report.success:
            return Ratings(report.sequence, (None,) * len(CRITERIA), report.features)
        episode = report.sequence - 1
        generator = keyed_generator(self._seed, episode, self._stream)
        weights = self._earlier if episode < self._earlier_episodes else self._weights
        return Ratings(report.sequence, rate(report.features, weights, generator, self._habits), report.features)
