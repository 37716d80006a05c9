"""Tables in three languages: the same cells, nothing that breaks the language."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.reporting import table as mut

TABLE = mut.Table(
    "small",
    "50 % of a_b ≤ 1 < 2.",
    ("who", "d", "plans"),
    (mut.Group((("A & B", "0.1 ± 0.2", "3"), ("C", "–", "4"))), mut.Group((("all", "1", "7"),), "In & all")),
)
cells = st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=12)


class Cells(HTMLParser):
    """Collects the text of cells, and fails on a tag that is not closed."""

    def __init__(self):
        super().__init__()
        self.open, self.found = [], []

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)
        if tag in ("td", "th"):
            self.found.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.found[-1] += data


def test_markdown_is_aligned():
    assert TABLE.to_markdown() == (
        "| who          |         d | plans |\n"
        "| ------------ | --------: | ----: |\n"
        "| A & B        | 0.1 ± 0.2 |     3 |\n"
        "| C            |         – |     4 |\n"
        "| **In & all** |           |       |\n"
        "| all          |         1 |     7 |\n"
        "\n"
        "50 % of a_b ≤ 1 < 2.\n"
    )


def test_a_bar_in_a_cell_stays_in_its_cell():
    text = mut.Table("t", "", ("a", "b"), (mut.Group((("x|y", "1"),)),)).to_markdown()
    assert "| x\\|y |" in text


def test_latex_has_the_rules_of_booktabs():
    text = TABLE.to_latex()
    assert r"\begin{tabular}{lrr}" in text
    assert r"    A \& B & 0.1 $\pm$ 0.2 & 3 \\" in text
    assert r"    C & -- & 4 \\" in text
    assert r"\caption{50 \% of a\_b $\le$ 1 $<$ 2.}" in text
    assert r"    \multicolumn{3}{l}{\textit{In \& all}} \\" in text
    assert [text.count(rule) for rule in (r"\toprule", r"\midrule", r"\bottomrule")] == [1, 2, 1]


def balanced(latex):
    """Whether environments are closed in order and braces and dollars pair up."""
    stack = []
    for kind, name in re.findall(r"\\(begin|end)\{(\w+)\}", latex):
        if kind == "begin":
            stack.append(name)
        elif not stack or stack.pop() != name:
            return False
    depth = 0
    for sign in re.sub(r"\\[{}$\\]", "", latex):
        depth += {"{": 1, "}": -1}.get(sign, 0)
        if depth < 0:
            return False
    return not stack and depth == 0 and re.sub(r"\\\$", "", latex).count("$") % 2 == 0


@given(first=cells, second=cells, caption=cells)
def test_any_text_makes_latex_that_is_balanced_with_one_cell_a_column(first, second, caption):
    text = mut.Table("t", caption, ("a", "b"), (mut.Group(((first, second),)),)).to_latex()
    assert balanced(text)
    body = text.split("\\midrule\n")[1].split("\n    \\bottomrule")[0]
    assert len(re.findall(r"(?<!\\)&", body)) == 1
    assert not re.search(r"(?<!\\)[%#_]", body)


@given(first=cells, second=cells)
def test_any_text_makes_html_that_says_it(first, second):
    parser = Cells()
    parser.feed(mut.Table("t", "", ("a", "b"), (mut.Group(((first, second),), "g"),)).to_html())
    assert parser.open == []
    assert parser.found == ["a", "b", "g", first, second]


def test_a_row_that_is_too_short_is_refused():
    with pytest.raises(ValueError, match="1 cells under 2 headings"):
        mut.Table("t", "", ("a", "b"), (mut.Group((("x",),)),))
