"""Learned targets (row U5): where a place really is, from the mismatch at the end of the legs that lead to it.

The paper's p^w <- p^w - alpha E dE/dp^w, p^w = z_target, with the continuous mismatch E = 1 - mu of the expected atom
and dE/dp^w through the leg's closed-loop sensitivity. A constant alpha has to be chosen by target, because the slope of
mu and the leg enter it; Gauss and Newton's alpha = 1 / |dE/dp^w|^2 has not, for it adapts to both. The step is bounded
by a trust region whose radius falls as 1 / n, so that any displacement can be reached, and noise matters less and less.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.messages import LearnedTargets

IsFree = Callable[[tuple[float, float]], bool]

_OFFSET_X, _OFFSET_Y, _UPDATES, _FINE = range(4)
_ENTRIES = 4  # Of the state, one row a place.

_LEAST_SLOPE = 1e-3  # 1/m; a mismatch that moves less than this with the target says nothing about the target.
_LEAST_SINGULAR = 0.05  # Of the leg's sensitivity: in a direction that moves the robot less, the target stays.
_ENOUGH = 4  # Errors below the tolerance, after which a target is not refined any more.
_SHARES = (0.75, 0.5, 0.25)  # Of a step, tried in turn until the robot can stand there.
_EXTENSIONS = (0.0, 0.25, 0.5, 0.75)  # Metres that a step may go on over the plateau, tried before.


@dataclass(frozen=True, slots=True)
class TargetEvidence:
    """What the end of one leg says about its target.

    Attributes:
        error: E = 1 - mu of the expected atom at the reached position, in [0, 1].
        error_gradient: dE / d target, (2,), 1/m.
        offset: from the reached position to the place as it was seen, (2,), metres; None if only E is to be used.
        sensitivity: d reached position / d target, (2, 2).
    """

    error: float
    error_gradient: FloatArray
    offset: FloatArray | None
    sensitivity: FloatArray


class TargetEstimator(AbstractLearner):
    """Moves targets to where the mismatch vanishes.

    By the fuzzy mismatch alone a target ends on the plateau of the membership, where nothing tells one point from
    another: the step aims twice the `tolerance` past its edge, since the robot may stop that far from its target this
    time and the next. With the geometric error as well it ends at the place itself; what is below `tolerance` is
    averaged, not followed.

    Like other learners it holds settings only. What is learned is one vector: for each place the target's displacement
    from the map in metres, the number of updates, and how many of them were below the tolerance.

    Attributes:
        places: names, in the order of the state.
    """

    def __init__(
        self,
        nominal: Mapping[str, tuple[float, float]],
        *,
        tolerance: float = 0.15,
        trust_radius: float = 2.5,
        decay: float = 0.1,
        farthest: float = 5.0,
    ) -> None:
        """Constructs the estimator.

        Args:
            nominal: targets (x, y) as on the map, by place, metres.
            tolerance: metres from its target at which the robot may stop, > 0.
            trust_radius: metres that the first update moves a target at most, > 0; more only if something stands there.
            decay: update n moves it 1 / (1 + decay n) times as far at most, >= 0.
            farthest: metres that a target may be from the map, > 0.

        Raises:
            BadInput: if a number is out of its range.
        """
        for name, value in (("tolerance", tolerance), ("trust_radius", trust_radius), ("farthest", farthest)):
            if not (math.isfinite(value) and value > 0.0):
                raise BadInput(name, str(value), "a finite number > 0")
        if not (math.isfinite(decay) and decay >= 0.0):
            raise BadInput("decay", str(decay), "a finite number >= 0")
        self.places = tuple(sorted(nominal))
        self._nominal = {name: (float(x), float(y)) for name, (x, y) in nominal.items()}
        for name, point in self._nominal.items():
            if not all(map(math.isfinite, point)):
                raise BadInput(f"nominal target {name}", str(point), "finite numbers")
        self._tolerance = tolerance
        self._trust_radius = trust_radius
        self._decay = decay
        self._farthest = farthest

    def initial_state(self) -> FloatArray:
        """The state before any leg: (4 n,) for n places."""
        return np.zeros(_ENTRIES * len(self.places))

    def update(
        self, state: FloatArray, place: str, evidence: TargetEvidence, *, is_free: IsFree | None = None
    ) -> FloatArray:
        """The state after one leg to `place`; unchanged if it says nothing.

        Args:
            state: before; not modified.
            place: that the leg led to. One that is not known, and evidence that is not finite, teach nothing.
            evidence: from the end of the leg.
            is_free: whether the robot can stand at a point (x, y), as far as it knows; None for everywhere. A step to
                where it cannot is shortened.
        """
        if place not in self.places or not _is_finite(evidence):
            return state.copy()
        after = state.copy()
        row = after.reshape(-1, _ENTRIES)[self.places.index(place)]
        step = self._gauss_newton(evidence, fine=row[_FINE])
        if not step.any():
            return after
        lengths = self._lengths(float(np.linalg.norm(step)), evidence, updates=row[_UPDATES])
        share = self._free_share(place, row[[_OFFSET_X, _OFFSET_Y]], step, lengths, is_free)
        if share == 0.0:
            return after
        row[[_OFFSET_X, _OFFSET_Y]] += share * step
        row[_UPDATES] += 1.0
        row[_FINE] += evidence.error == 0.0 and self._is_fine(evidence)
        return after

    def is_settled(self, state: FloatArray, place: str, error: float, offset: FloatArray | None) -> bool:
        """Whether the end of a leg has nothing more to teach, so that its sensitivity need not be found out.

        Args:
            state: of the learner.
            place: that the leg led to.
            error: E at its end.
            offset: what is left to the place as it was seen; None if only E is to be used.
        """
        if place not in self.places:
            return True
        if error > 0.0 or offset is None:
            return error == 0.0
        updates, fine = state.reshape(-1, _ENTRIES)[self.places.index(place), [_UPDATES, _FINE]].tolist()
        return float(np.linalg.norm(offset)) <= self._tolerance and (updates == 0.0 or fine >= _ENOUGH)

    def target(self, state: FloatArray, place: str) -> tuple[float, float]:
        """The target (x, y) of a place, metres."""
        row = state.reshape(-1, _ENTRIES)[self.places.index(place)]
        x, y = self._nominal[place]
        return x + float(row[_OFFSET_X]), y + float(row[_OFFSET_Y])

    def updates(self, state: FloatArray, place: str) -> int:
        """How often the target of a place was moved."""
        return int(state.reshape(-1, _ENTRIES)[self.places.index(place), _UPDATES])

    def learned(self, state: FloatArray) -> LearnedTargets:
        """What the controller is told: the targets that were moved."""
        moved = [place for place in self.places if self.updates(state, place)]
        targets = tuple((place, *self.target(state, place)) for place in moved)
        return LearnedTargets(targets, sum(self.updates(state, place) for place in moved))

    def _is_fine(self, evidence: TargetEvidence) -> bool:
        return evidence.offset is not None and float(np.linalg.norm(evidence.offset)) <= self._tolerance

    def _gauss_newton(self, evidence: TargetEvidence, *, fine: float) -> FloatArray:
        """The least-squares step that would bring what is left to zero, were the leg linear in its target."""
        rows, residuals = np.zeros((0, 2)), np.zeros(0)
        slope = float(np.linalg.norm(evidence.error_gradient))
        if evidence.error > 0.0 and slope > _LEAST_SLOPE:
            past = 0.0 if evidence.offset is not None else 2.0 * self._tolerance * slope
            rows, residuals = evidence.error_gradient[None], np.array([-evidence.error - past])
        if evidence.offset is not None:
            gain = 1.0 / (2.0 + fine) if self._is_fine(evidence) else 1.0
            rows = np.vstack((rows, evidence.sensitivity))
            residuals = np.concatenate((residuals, gain * evidence.offset))
        if not residuals.size:
            return np.zeros(2)
        largest = float(np.linalg.norm(rows, 2))
        # One row has one singular value; a second one that is small must not blow the step up.
        cutoff = min(_LEAST_SINGULAR / largest, 1.0) if len(rows) > 1 and largest > 0.0 else 0.0
        return np.asarray(np.linalg.pinv(rows, rcond=cutoff) @ residuals)

    def _radius(self, updates: float) -> float:
        return self._trust_radius / (1.0 + self._decay * updates)

    def _lengths(self, length: float, evidence: TargetEvidence, *, updates: float) -> tuple[float, ...]:
        """The lengths of a step by preference: within the trust region, beyond what is in the way, nearer.

        What stands between the target and the place is only passed by a long step; a step over the plateau may go on.
        """
        farther = _EXTENSIONS if evidence.offset is None else _EXTENSIONS[:1]
        trusted = min(length, self._radius(updates))
        return (trusted, *(length + more for more in farther), *(share * trusted for share in _SHARES))

    def _free_share(
        self, place: str, offset: FloatArray, step: FloatArray, lengths: tuple[float, ...], is_free: IsFree | None
    ) -> float:
        """How many times the step leads to where the robot can stand, 0 if none of the lengths does."""
        nominal, length = np.array(self._nominal[place]), float(np.linalg.norm(step))
        for tried in lengths:
            reached = offset + tried / length * step
            x, y = (nominal + reached).tolist()
            if np.linalg.norm(reached) <= self._farthest and (is_free is None or is_free((x, y))):
                return tried / length
        return 0.0


def _is_finite(evidence: TargetEvidence) -> bool:
    numbers = [np.array([evidence.error]), evidence.error_gradient, evidence.sensitivity.ravel()]
    if evidence.offset is not None:
        numbers.append(evidence.offset)
    return bool(np.isfinite(np.concatenate(numbers)).all())
