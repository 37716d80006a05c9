"""Makes an SVG document part of an HTML page: names of its own, colors that follow the page, no link to anywhere."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from mala_drake.reporting.figures.style import (
    BUSY,
    CRITERION_COLORS,
    FAINT,
    FLOOR,
    FURNITURE,
    INK,
    MUTED,
    PAPER,
    PLACE_COLORS,
    WALL,
)

COLOR_VARIABLES: Mapping[str, str] = MappingProxyType(
    {
        INK: "--ink",
        MUTED: "--muted",
        FAINT: "--faint",
        PAPER: "--paper",
        FURNITURE: "--furniture",
        WALL: "--wall",
        FLOOR: "--floor",
        BUSY: "--busy",
        **{color: f"--{criterion}" for criterion, color in CRITERION_COLORS.items()},
        **{color: f"--{kind}" for kind, color in PLACE_COLORS.items()},
    }
)
"""Colors of the figures that the page replaces by its own, so that they suit a light and a dark ground."""

_REMOVED = (r"<\?xml.*?\?>", r"<!DOCTYPE.*?>", r"<!--.*?-->", r"<metadata>.*?</metadata>", r"<style.*?</style>")
# A hundredth of a point is finer than anything that can be seen; numbers below 1 may be scales, so they stay whole.
_DIGITS = re.compile(r"(?<![\d.])([1-9]\d*\.\d{2})\d+")


def inline_svg(document: str, *, name: str, title: str) -> str:
    """An SVG document of matplotlib's as an element of a page.

    Args:
        document: with its style of line ends and joins left to the page.
        name: begins every id, so that those of different pictures differ.
        title: what the picture is, for who cannot see it.
    """
    for pattern in _REMOVED:
        document = re.sub(pattern, "", document, flags=re.DOTALL)
    head, body = re.split(r"(?<=>)", document.strip(), maxsplit=1)
    box = re.search(r'viewBox="([^"]*)"', head)
    if box is None:
        raise ValueError(f"picture {name} has no viewBox")
    body = re.sub(r'\bid="', f'id="{name}-', body)
    body = re.sub(r"url\(#", f"url(#{name}-", body)
    body = re.sub(r'xlink:href="#', f'href="#{name}-', body)
    body = _DIGITS.sub(r"\1", body)
    for color, variable in COLOR_VARIABLES.items():
        body = body.replace(color, f"var({variable})")
    body = re.sub(r"\n\s*", "\n", body)
    return f'<svg viewBox="{box.group(1)}" role="img" aria-label="{_attribute(title)}">{body}'


def _attribute(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
