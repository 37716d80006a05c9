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
        "–": "--",
        "→": r"$\rightarrow$",
        "×": r"$\times$",
    }
)


@dataclass(frozen=True)
class Table:
    """Rows of cells under headings. The first column is text, the others figures.

    Attributes:
        name: of its files, without suffix, and its label in LaTeX.
        caption: one or more sentences.
        headings: one a column.
        groups: of rows that belong together, each row with one cell a column.
    """

    name: str
    caption: str
    headings: tuple[str, ...]
    groups: tuple[tuple[tuple[str, ...], ...], ...]

    def __post_init__(self) -> None:
        for row in (row for group in self.groups for row in group):
            if len(row) != len(self.headings):
                raise ValueError(f"{len(row)} cells under {len(self.headings)} headings: {row}")

    def to_markdown(self) -> str:
        """The table for a README."""
        rows = [row for group in self.groups for row in group]
        widths = [max(map(len, column)) for column in zip(self.headings, *rows, strict=True)]
        rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in (max(each, 2) for each in widths[1:]))]
        lines = [_markdown_row(self.headings, widths), "| " + " | ".join(rule) + " |"]
        lines += [_markdown_row(row, widths) for row in rows]
        return "\n".join([*lines, "", self.caption, ""])

    def to_latex(self) -> str:
        """The table for a paper; needs the package booktabs."""
        head = " & ".join(rf"\textbf{{{_latex(heading)}}}" for heading in self.headings)
        lines = [
            r"\begin{table}[htbp]",
            r"  \centering",
            r"  \small",
            rf"  \begin{{tabular}}{{l{'r' * (len(self.headings) - 1)}}}",
            r"    \toprule",
            rf"    {head} \\",
        ]
        for group in self.groups:
            lines.append(r"    \midrule")
            lines += [rf"    {' & '.join(map(_latex, row))} \\" for row in group]
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
        bodies = "\n".join(f"<tbody>\n{_html_rows(group)}\n</tbody>" for group in self.groups)
        return f"<table>\n<thead><tr>{head}</tr></thead>\n{bodies}\n</table>"


def _markdown_row(cells: tuple[str, ...], widths: list[int]) -> str:
    escaped = (cell.replace("|", r"\|") for cell in cells)
    first, *others = (
        cell.ljust(width) if i == 0 else cell.rjust(width)
        for i, (cell, width) in enumerate(zip(escaped, widths, strict=True))
    )
    return "| " + " | ".join([first, *others]) + " |"


def _latex(text: str) -> str:
    return text.translate(_LATEX)


def _html_rows(rows: tuple[tuple[str, ...], ...]) -> str:
    return "\n".join(
        f'<tr><th scope="row">{html.escape(first)}</th>'
        + "".join(f"<td>{html.escape(cell)}</td>" for cell in others)
        + "</tr>"
        for first, *others in rows
    )
