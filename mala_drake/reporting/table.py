"""A table of text, written as Markdown, LaTeX or HTML."""

from __future__ import annotations

import html
from dataclasses import dataclass

_LATEX = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "±": r"$\pm$",
        "≤": r"$\le$",
        "<": r"$<$",
        ">": r"$>$",
        "|": r"$|$",
        "−": r"$-$",
        "·": r"$\cdot$",
        "–": "--",
        "→": r"$\rightarrow$",
        "×": r"$\times$",
        "ψ": r"$\psi$",
    }
)


Row = tuple[str, ...]

_FEW_COLUMNS = 6  # That fit between the margins of a page in LaTeX's small type.


@dataclass(frozen=True)
class Group:
    """Rows that belong together, under a title unless that is empty."""

    rows: tuple[Row, ...]
    title: str = ""


@dataclass(frozen=True)
class Table:
    """Rows of cells under headings. The first column is text, the others figures.

    Attributes:
        name: of its files, without suffix, and its label in LaTeX.
        caption: one or more sentences.
        headings: one a column.
        groups: of rows, each row with one cell a column.
    """

    name: str
    caption: str
    headings: Row
    groups: tuple[Group, ...]

    def __post_init__(self) -> None:
        for row in (row for group in self.groups for row in group.rows):
            if len(row) != len(self.headings):
                raise ValueError(f"{len(row)} cells under {len(self.headings)} headings: {row}")

    def to_markdown(self) -> str:
        """The table for a README."""
        empty = ("",) * (len(self.headings) - 1)
        rows: list[Row] = []
        for group in self.groups:
            rows += [(f"**{group.title}**", *empty)] if group.title else []
            rows += group.rows
        widths = [max(2, *map(len, column)) for column in zip(self.headings, *rows, strict=True)]
        rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
        lines = [_markdown_row(self.headings, widths), "| " + " | ".join(rule) + " |"]
        lines += [_markdown_row(row, widths) for row in rows]
        return "\n".join([*lines, "", self.caption, ""])

    def to_latex(self) -> str:
        """The table for a paper; needs the package booktabs."""
        head = " & ".join(rf"\textbf{{{_latex(heading)}}}" for heading in self.headings)
        many = len(self.headings) > _FEW_COLUMNS
        lines = [
            r"\begin{table}[htbp]",
            r"  \centering",
            r"  \scriptsize" if many else r"  \small",
            *([r"  \setlength{\tabcolsep}{2.5pt}"] if many else []),
            rf"  \begin{{tabular}}{{l{'r' * (len(self.headings) - 1)}}}",
            r"    \toprule",
            rf"    {head} \\",
        ]
        for group in self.groups:
            lines.append(r"    \midrule")
            if group.title:
                lines.append(rf"    \multicolumn{{{len(self.headings)}}}{{l}}{{\textit{{{_latex(group.title)}}}}} \\")
            lines += [rf"    {' & '.join(map(_latex, row))} \\" for row in group.rows]
        lines += [
            r"    \bottomrule",
            r"  \end{tabular}",
            rf"  \caption{{{_latex(self.caption)}}}",
            rf"  \label{{tab:{self.name}}}",
            r"\end{table}",
        ]
        return "\n".join(lines) + "\n"

    def to_html(self) -> str:
        """The table as an HTML element, each group in a body of its own."""
        head = "".join(f'<th scope="col">{html.escape(heading)}</th>' for heading in self.headings)
        bodies = "\n".join(self._html_group(group) for group in self.groups)
        return f"<table>\n<thead><tr>{head}</tr></thead>\n{bodies}\n</table>"

    def _html_group(self, group: Group) -> str:
        columns = len(self.headings)
        title = (
            f'<tr><th scope="rowgroup" colspan="{columns}">{html.escape(group.title)}</th></tr>\n'
            if group.title
            else ""
        )
        return f"<tbody>\n{title}{_html_rows(group.rows)}\n</tbody>"


def _markdown_row(cells: Row, widths: list[int]) -> str:
    escaped = (cell.replace("|", r"\|") for cell in cells)
    first, *others = (
        cell.ljust(width) if i == 0 else cell.rjust(width)
        for i, (cell, width) in enumerate(zip(escaped, widths, strict=True))
    )
    return "| " + " | ".join([first, *others]) + " |"


def _latex(text: str) -> str:
    return text.translate(_LATEX)


def _html_rows(rows: tuple[Row, ...]) -> str:
    return "\n".join(
        f'<tr><th scope="row">{html.escape(first)}</th>'
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in others)
        + "</tr>"
        for first, *others in rows
    )
