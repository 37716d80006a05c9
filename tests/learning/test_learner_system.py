"""What all systems that learn have in common, on one that counts."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.systems.framework import Context

from mala_drake.learning import learner_system as mut
from mala_drake.messages import Ratings


class Counter(mut.LearnerSystem):
    def __init__(self):
        super().__init__()
        self._declare_learned("learned", Ratings(), initial_state=np.array([3.0, 4.0]), marks=3)

    def _learned(self, context: Context) -> Ratings:
        return Ratings(values=tuple(self.learner_state(context)), features=tuple(self._marks(context)))


@pytest.fixture
def counter():
    return Counter()


def learned(counter, context):
    said = counter.GetOutputPort("learned").Eval(context)
    return said.values, said.features


def test_it_begins_with_the_learner_s_own_state_and_no_marks(counter):
    assert learned(counter, counter.CreateDefaultContext()) == ((3.0, 4.0), (0.0, 0.0, 0.0))


def test_its_state_is_said_as_it_is(counter):
    context = counter.CreateDefaultContext()
    context.SetDiscreteState([1.0, 2.0, 7.0, 8.0, 9.0])
    assert learned(counter, context) == ((1.0, 2.0), (7.0, 8.0, 9.0))


def test_what_is_learned_outlives_the_episode_and_marks_do_not(counter):
    context, later = counter.CreateDefaultContext(), counter.CreateDefaultContext()
    context.SetDiscreteState([1.0, 2.0, 7.0, 8.0, 9.0])
    kept = counter.learner_state(context)
    later.SetDiscreteState([0.0, 0.0, 5.0, 6.0, 7.0])
    counter.set_learner_state(later, kept, episode=1)
    assert learned(counter, later) == ((1.0, 2.0), (0.0, 0.0, 0.0))


def test_a_checkpoint_is_a_copy(counter):
    context = counter.CreateDefaultContext()
    counter.learner_state(context)[0] = 5.0
    assert learned(counter, context)[0] == (3.0, 4.0)
