"""Pictures in a page: their own names, the page's colors, nothing from anywhere else."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from mala_drake.reporting import inline_svg as mut
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, new_figure, styled


@pytest.fixture
def element():
    with styled():
        figure = new_figure(2.0, 1.0)
        axes = figure.subplots()
        axes.plot([0, 1], [1, 0], color=INK, marker="o")
        axes.set_title("a")
        document = Picture("small", "A title", "", figure).svg()
    return mut.inline_svg(document, name="small", title='A "title" & <more>')


def test_nothing_in_it_points_elsewhere(element):
    assert "http" not in element
    assert "<style" not in element
    assert "<metadata" not in element


def test_it_is_one_whole_element_with_its_title(element):
    root = ElementTree.fromstring(element)
    assert root.tag == "svg"
    assert root.get("aria-label") == 'A "title" & <more>'
    assert root.get("width") is None


def test_ids_are_its_own_and_every_use_finds_one(element):
    ids = set(re.findall(r'\bid="([^"]*)"', element))
    assert ids
    assert all(each.startswith("small-") for each in ids)
    uses = set(re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', element))
    assert {a or b for a, b in uses} <= ids
    assert uses


def test_the_page_decides_on_the_colors(element):
    assert INK not in element
    assert MUTED not in element
    assert "var(--ink)" in element


def test_scales_keep_their_digits(element):
    assert re.search(r"scale\(0\.\d{4,}", element)
    assert not re.search(r'd="[^"]*[1-9]\d*\.\d{3}', element)


def test_what_is_no_picture_is_refused():
    with pytest.raises(ValueError, match="no viewBox"):
        mut.inline_svg("<svg></svg>", name="x", title="")
