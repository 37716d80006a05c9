import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.planning.source as mut
from mala_drake.errors import BadInput


def test_every_word_knows_its_place():
    source = mut.parse_source("; first\n(define (Domain\n  x) ; (not this)\n\t?V -1.5e2)", name="f.pddl")
    places = {symbol.text: source.place(symbol) for symbol in source.symbols}
    assert places == {
        "define": "f.pddl:2:2",
        "domain": "f.pddl:2:10",
        "x": "f.pddl:3:3",
        "?v": "f.pddl:4:2",
        "-1.5e2": "f.pddl:4:5",
    }
    assert source.symbols[-1].number == -150
    assert source.symbols[-2].is_variable


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "f: is empty"),
        ("(define (a)", "f:1:1: '(' is never closed"),
        ("(define\n))", "f:2:2: ')' without"),
        ("define", "f:1:1: not a PDDL definition"),
        ("(" * 300, "f:1:101: parentheses nested"),
    ],
)
def test_unbalanced_text_is_refused(text, line):
    with pytest.raises(BadInput) as caught:
        mut.parse_source(text, name="f")
    assert str(caught.value).startswith(line)


@given(st.text(alphabet="()d ef;\n?-1.", max_size=60))
def test_any_text_is_parsed_or_refused_in_one_line(text):
    try:
        source = mut.parse_source(f"(define {text}", name="f")
    except BadInput as error:
        source, line = None, str(error)
    if source is None:
        assert "\n" not in line
    else:
        assert [symbol.index for symbol in source.symbols] == list(range(len(source.symbols)))
