"""The report as one self-contained HTML page."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from string import Template

from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.findings import Figure
from mala_drake.reporting.inline_svg import inline_svg
from mala_drake.reporting.table import Table

_TEMPLATE = "report_page.html"


@dataclass(frozen=True)
class Section:
    """A part of the report; one without content is left out.

    Attributes:
        name: of its anchor.
        title: its heading.
        sentences: before the figures.
        content: pictures and tables in their order.
    """

    name: str
    title: str
    sentences: tuple[str, ...] = ()
    content: tuple[Picture | Table, ...] = field(default=())


def report_page(
    *, title: str, lead: str, headline: Iterable[Figure], problems: Sequence[str], sections: Iterable[Section]
) -> str:
    """The page: pictures are in it as SVG, and it asks for nothing from anywhere."""
    shown = [section for section in sections if section.content or section.sentences]
    template = Template(files("mala_drake.reporting").joinpath(_TEMPLATE).read_text(encoding="utf-8"))
    counter = _Counter()
    return template.substitute(
        title=html.escape(title),
        lead=html.escape(lead),
        tiles="\n".join(map(_tile, headline)),
        problems=_problems(problems),
        contents=" ".join(f'<a href="#{section.name}">{html.escape(section.title)}</a>' for section in shown),
        sections="\n".join(_section(section, counter) for section in shown),
    )


class _Counter:
    """Numbers figures and tables through the page."""

    def __init__(self) -> None:
        self._last = {"Figure": 0, "Table": 0}

    def next(self, kind: str) -> str:
        self._last[kind] += 1
        return f"{kind} {self._last[kind]}"


def _tile(figure: Figure) -> str:
    kind = {True: ' class="good"', False: ' class="bad"', None: ""}[figure.good]
    return f"<li{kind}><b>{html.escape(figure.value)}</b><span>{html.escape(figure.meaning)}</span></li>"


def _problems(problems: Sequence[str]) -> str:
    if not problems:
        return '<p class="well">No episode failed, nothing was touched, every run converged, and no run is missing.</p>'
    items = "\n".join(f"<li>{html.escape(problem)}</li>" for problem in problems)
    return f'<section class="problems">\n<h2>What went wrong or is missing</h2>\n<ul>\n{items}\n</ul>\n</section>'


def _section(section: Section, counter: _Counter) -> str:
    parts = [f'<section id="{section.name}">', f"<h2>{html.escape(section.title)}</h2>"]
    if len(section.sentences) > 2:
        parts.append("<ul>" + "".join(f"<li>{html.escape(each)}</li>" for each in section.sentences) + "</ul>")
    else:
        parts += [f"<p>{html.escape(each)}</p>" for each in section.sentences]
    for item in section.content:
        parts.append(_picture(item, counter) if isinstance(item, Picture) else _table(item, counter))
    return "\n".join([*parts, "</section>"])


def _picture(picture: Picture, counter: _Counter) -> str:
    drawing = inline_svg(picture.svg(), name=picture.name, title=f"{picture.title}. {picture.caption}")
    words = f"<b>{counter.next('Figure')}. {html.escape(picture.title)}.</b> {html.escape(picture.caption)}"
    return f'<figure>\n<div class="drawing">{drawing}</div>\n<figcaption>{words}</figcaption>\n</figure>'


def _table(table: Table, counter: _Counter) -> str:
    note = f'<p class="note"><b>{counter.next("Table")}.</b> {html.escape(table.caption)}</p>'
    return f'<div class="table">\n{table.to_html()}\n</div>\n{note}'
