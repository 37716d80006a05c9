"""The normal form has the value of the expression it came from."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

import mala_drake.planning.polynomial as mut
from mala_drake.planning.syntax import Arithmetic, Fluent

number = st.fractions(-3, 3, max_denominator=4)
leaf = st.one_of(number, st.sampled_from("abc").map(lambda name: Fluent(name, ())))


def arithmetic(inner):
    pair = st.tuples(inner, inner)
    return st.one_of(
        st.tuples(st.sampled_from("+*"), st.lists(inner, min_size=1, max_size=3).map(tuple)),
        st.tuples(st.sampled_from("-/"), pair),
        st.tuples(st.just("-"), st.tuples(inner)),
    ).map(lambda parts: Arithmetic(*parts))


expressions = st.recursive(leaf, arithmetic, max_leaves=8)
values = st.fixed_dictionaries({}, optional={(name,): number for name in "abc"})


def direct(expression, known):
    """The value by definition; None if undefined."""
    if isinstance(expression, Fraction):
        return expression
    if isinstance(expression, Fluent):
        return known.get((expression.name,))
    operands = [direct(operand, known) for operand in expression.operands]
    if None in operands:
        return None
    first, *rest = operands
    for operand in rest:
        if expression.operator == "/" and operand == 0:
            return None
        first = {
            "+": lambda a, b: a + b,
            "-": lambda a, b: a - b,
            "*": lambda a, b: a * b,
            "/": lambda a, b: a / b,
        }[expression.operator](first, operand)
    return -first if expression.operator == "-" and not rest else first


def normal_form(expression):
    return mut.expand(expression, lambda fluent: mut.variable((fluent.name,), static=fluent.name == "a"))


@given(expressions, values)
def test_has_the_value_of_the_expression(expression, known):
    assert mut.evaluate(normal_form(expression), known) == direct(expression, known)


@given(expressions, expressions)
def test_sums_and_products_commute(left, right):
    a, b = normal_form(left), normal_form(right)
    assert a + b == b + a
    assert a * b == b * a


def test_what_cancels_must_still_be_defined():
    x = mut.variable(("x",), static=False)
    assert mut.evaluate(x - x, {}) is None
    assert mut.evaluate(x - x, {("x",): Fraction(3)}) == 0
    assert (x - x).fluents() == {("x",)}
