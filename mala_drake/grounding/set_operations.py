"""Union, intersection and complement: fuzzy sets made from fuzzy sets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.membership import AbstractMembership, FloatArray
from mala_drake.grounding.minimum_norms import MinimumNorms
from mala_drake.grounding.norms import AbstractNorms

_MINIMUM = MinimumNorms()  # The paper's: union by max, intersection by min.


@dataclass(frozen=True, slots=True)
class Union(AbstractMembership):
    """The fuzzy set of what belongs to any of the members, by the t-conorm of `norms`."""

    members: tuple[AbstractMembership, ...]
    norms: AbstractNorms = _MINIMUM

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """S of the members' memberships."""
        return self.norms.disjunction(_values(self.members, x))

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """By the chain rule."""
        return _chain(self.norms.disjunction_gradient(_values(self.members, x)), self.members, x)


@dataclass(frozen=True, slots=True)
class Intersection(AbstractMembership):
    """The fuzzy set of what belongs to all of the members, by the t-norm of `norms`."""

    members: tuple[AbstractMembership, ...]
    norms: AbstractNorms = _MINIMUM

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """T of the members' memberships."""
        return self.norms.conjunction(_values(self.members, x))

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """By the chain rule."""
        return _chain(self.norms.conjunction_gradient(_values(self.members, x)), self.members, x)


@dataclass(frozen=True, slots=True)
class Complement(AbstractMembership):
    """The fuzzy set of what does not belong to `member`: 1 - mu."""

    member: AbstractMembership

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """1 - mu(x)."""
        return 1.0 - self.member.value(x)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """The member's, with the other sign."""
        return -self.member.derivative(x)


def _values(members: tuple[AbstractMembership, ...], x: npt.ArrayLike) -> FloatArray:
    columns = [member.value(x) for member in members]
    return np.stack(columns, axis=-1) if columns else np.zeros((*np.shape(x), 0))


def _chain(gradient: FloatArray, members: tuple[AbstractMembership, ...], x: npt.ArrayLike) -> FloatArray:
    terms = [gradient[..., index] * member.derivative(x) for index, member in enumerate(members)]
    return np.sum(terms, axis=0) if terms else np.zeros(np.shape(x))
