"""Learned targets (row U5): where a place really is, from the mismatch at the end of the legs that lead to it.

The paper's p^w <- p^w - alpha E dE/dp^w, p^w = z_target, with the continuous mismatch E = 1 - mu of the expected atom
and dE/dp^w through the leg's closed-loop sensitivity. A constant alpha has to be chosen by target, because the slope of
mu and the leg enter it; Gauss and Newton's alpha = 1 / |dE/dp^w|^2 has not, for it adapts to both. The step is bounded
by a trust region whose radius falls as 1 / n, so that any displacement can be reached, and noise matters less and less.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.learning.shortest_step import shortest_step
from mala_drake.messages import LearnedTargets

IsFree = Callable[[tuple[float, float]], bool]

_OFFSET_X, _OFFSET_Y, _UPDATES, _FINE = range(4)
_ENTRIES = 4  # Of the state, one row a place.

_LEAST_SLOPE = 1e-3  # 1/m; a mismatch that moves less than this with the target says nothing about the target.
_LEAST_SINGULAR = 0.05  # Of the leg's sensitivity: in a direction that moves the robot less, the target stays.
_ENOUGH = 4  # Errors below the tolerance, after which a target is not refined any more.
_SHARES = (0.75, 0.5, 0.25)  # Of a step, tried in turn until the robot can stand there.
_EXTENSIONS = (0.0, 0.25, 0.5, 0.75)  # Metres that a step may go on over the plateau, tried before.
_TURNS = tuple(
    math.radians(angle) for angle in (15.0, 30.0, 45.0, 60.0, 75.0)
)  # Of a step, to pass what is in the way.

PLATEAU_MARGIN = 0.3
"""Metres past the plateau's edge that a step aims at: the robot may stop half of that from its target this time and the
next."""


@dataclass(frozen=True, slots=True)
class MissingAtom:
    """An expected atom and how far it is from being true.

    Attributes:
        error: E = 1 - mu of the atom at the reached position, in [0, 1].
        gradient: dE / d target, (2,), 1/m.
        margin: metres past the edge of the atom's plateau to aim at.
    """

    error: float
    gradient: FloatArray
    margin: float = PLATEAU_MARGIN

    @property
    def demand(self) -> FloatArray:
        """The shortest step of the target that makes the atom true, with its margin, (2,), metres; 0 if there is none.

        It is Gauss and Newton's, -E dE / |dE|^2, and goes on by the margin.
        """
        slope = float(np.linalg.norm(self.gradient))
        if not (self.error > 0.0 and slope > _LEAST_SLOPE):
            return np.zeros(2)
        return np.asarray(-(self.error / slope + self.margin) / slope * self.gradient)


@dataclass(frozen=True, slots=True)
class TargetEvidence:
    """What the end of a leg, or an action after it, says about the leg's target.

    Attributes:
        missing: the expected atoms that may not be true.
        offset: from the reached position to the place as it was seen, (2,), metres; None if only atoms are to be used.
        sensitivity: d reached position / d target, (2, 2).
        target: (x, y) that the leg was to end at, metres; None if it is the present one.
    """

    missing: tuple[MissingAtom, ...]
    offset: FloatArray | None
    sensitivity: FloatArray
    target: tuple[float, float] | None = None

    @property
    def demands(self) -> list[FloatArray]:
        """The steps that the missing atoms ask for."""
        return [demand for atom in self.missing if (demand := atom.demand).any()]


class TargetEstimator(AbstractLearner):
    """Moves targets to where the mismatch vanishes.

    By the fuzzy mismatch alone a target ends on the plateaus of the memberships, where nothing tells one point from
    another: the step is the shortest that is past the edge of each. With the geometric error as well it ends at the
    place itself; what is below `tolerance` is averaged, not followed.

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
        step = shortest_step(evidence.demands) if evidence.offset is None else self._gauss_newton(evidence, row[_FINE])
        if not step.any():
            return after
        about = np.array(self.target(state, place) if evidence.target is None else evidence.target)
        reached = self._first_free(place, about, self._steps(step, evidence, updates=row[_UPDATES]), is_free)
        if reached is None:
            return after
        row[[_OFFSET_X, _OFFSET_Y]] = reached
        row[_UPDATES] += 1.0
        row[_FINE] += not evidence.demands and _is_within(self._tolerance, evidence.offset)
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

    def _gauss_newton(self, evidence: TargetEvidence, fine: float) -> FloatArray:
        """The least-squares step that would bring what is left to zero, were the leg linear in its target."""
        gain = 1.0 / (2.0 + fine) if _is_within(self._tolerance, evidence.offset) else 1.0
        rows = np.vstack((*(atom.gradient for atom in evidence.missing if atom.demand.any()), evidence.sensitivity))
        missing = [-atom.error for atom in evidence.missing if atom.demand.any()]
        residuals = np.concatenate((missing, gain * np.asarray(evidence.offset)))
        # A singular value that is small must not blow the step up.
        largest = float(np.linalg.norm(rows, 2))
        cutoff = min(_LEAST_SINGULAR / largest, 1.0) if largest > 0.0 else 0.0
        return np.asarray(np.linalg.pinv(rows, rcond=cutoff) @ residuals)

    def _radius(self, updates: float) -> float:
        return self._trust_radius / (1.0 + self._decay * updates)

    def _steps(self, step: FloatArray, evidence: TargetEvidence, *, updates: float) -> Iterator[FloatArray]:
        """Steps by preference: within the trust region, beyond what is in the way, round it, nearer.

        What stands between the target and the place is only passed by a long step; a step over a plateau may go on, or
        aside.
        """
        length, straight = float(np.linalg.norm(step)), evidence.offset is not None
        # A target at the very edge of the plateau may be on it or not: a step that is longer by the margin goes on.
        radius = self._radius(updates)
        trusted = length if length <= radius + (0.0 if straight else PLATEAU_MARGIN) else radius
        yield trusted / length * step
        for more in _EXTENSIONS[:1] if straight else _EXTENSIONS:
            yield (length + more) / length * step
        if not straight:
            yield from _aside(step, evidence.demands)
        for share in _SHARES:
            yield share * trusted / length * step

    def _first_free(
        self, place: str, about: FloatArray, steps: Iterable[FloatArray], is_free: IsFree | None
    ) -> FloatArray | None:
        """Where the first step leads that ends where the robot can stand, as displacement from the map."""
        nominal = np.array(self._nominal[place])
        for step in steps:
            displacement = about - nominal + step
            x, y = (about + step).tolist()
            if np.linalg.norm(displacement) <= self._farthest and (is_free is None or is_free((x, y))):
                return np.asarray(displacement)
        return None


def _aside(step: FloatArray, demands: Sequence[FloatArray]) -> list[FloatArray]:
    """Steps in other directions that meet the same demands, the shortest first."""
    longest = float(np.linalg.norm(step)) + _EXTENSIONS[-1]
    found = []
    for turn in _TURNS:
        for angle in (turn, -turn):
            cosine, sine = math.cos(angle), math.sin(angle)
            direction = np.array([[cosine, -sine], [sine, cosine]]) @ step / np.linalg.norm(step)
            progress = [float(demand @ direction) / float(demand @ demand) for demand in demands]
            if min(progress) > 0.0 and 1.0 / min(progress) <= longest:
                found.append(direction / min(progress))
    return sorted(found, key=lambda each: float(np.linalg.norm(each)))


def _is_within(tolerance: float, offset: FloatArray | None) -> bool:
    return offset is not None and float(np.linalg.norm(offset)) <= tolerance


def _is_finite(evidence: TargetEvidence) -> bool:
    numbers = [np.array([atom.error, *atom.gradient]) for atom in evidence.missing]
    numbers += [
        np.ravel(given) for given in (evidence.sensitivity, evidence.offset, evidence.target) if given is not None
    ]
    return bool(np.isfinite(np.concatenate(numbers)).all())
