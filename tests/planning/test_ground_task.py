"""The logic of ground conditions, against the truth of their parts in every state."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from mala_drake.planning import ground_task as mut

FACTS = (("p",), ("q",), ("r",))
STATES = [
    frozenset(fact for fact, there in zip(FACTS, bits, strict=True) if there) for bits in product((0, 1), repeat=3)
]

facts = st.frozensets(st.sampled_from(FACTS), max_size=2)
literals = st.builds(lambda positive, negative: mut.Condition(positive, negative - positive), facts, facts)
conditions = st.recursive(
    st.none() | literals,
    lambda inner: (
        st.builds(mut.conjunction, st.lists(inner, max_size=3))
        | st.builds(mut.disjunction, st.lists(inner, max_size=3))
    ),
    max_leaves=6,
)


def holds(condition, state):
    """By the definition; None is false."""
    return (
        condition is not None
        and condition.positive <= state
        and not condition.negative & state
        and all(any(holds(part, state) for part in choice) for choice in condition.choices)
    )


@given(st.lists(conditions, max_size=4))
def test_all_and_any_of_conditions_hold_where_all_and_any_of_them_do(parts):
    for state in STATES:
        truths = [holds(part, state) for part in parts]
        assert holds(mut.conjunction(parts), state) == all(truths)
        assert holds(mut.disjunction(parts), state) == any(truths)


def test_what_contradicts_itself_is_false_and_what_always_holds_is_true():
    p = frozenset({("p",)})
    assert mut.conjunction([mut.Condition(positive=p), mut.Condition(negative=p)]) is None
    assert mut.disjunction([mut.Condition(positive=p), mut.TRUE]) == mut.TRUE


@given(conditions)
def test_the_parts_of_a_condition_are_all_that_it_mentions(condition):
    if condition is None:
        return
    parts = list(condition.parts())
    assert parts[0] == condition
    assert all(choice in parts for part in parts for one in part.choices for choice in one)


def test_effects_under_the_same_condition_become_one():
    p, q = (frozenset({fact}) for fact in FACTS[:2])
    when = mut.Condition(positive=p)
    effects = [mut.Effect(when, p, q, ()), mut.Effect(mut.TRUE, q, p, ()), mut.Effect(when, q, p, ())]
    assert mut.merged(effects) == (mut.Effect(when, p | q, p | q, ()), mut.Effect(mut.TRUE, q, p, ()))
