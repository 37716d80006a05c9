"""A finished figure: what it is called, what it shows, and its files."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DOTS_PER_INCH = 200


@dataclass(frozen=True)
class Picture:
    """A figure with its words.

    Attributes:
        name: of its files, without suffix.
        title: a few words.
        caption: what is drawn, in sentences.
        figure: the drawing.
    """

    name: str
    title: str
    caption: str
    figure: Figure

    def write(self, folder: Path) -> tuple[Path, Path]:
        """Writes the picture as PNG and as PDF, the same bytes each time."""
        png, pdf = folder / f"{self.name}.png", folder / f"{self.name}.pdf"
        self.figure.savefig(png, dpi=_DOTS_PER_INCH, metadata={"Software": None})
        self.figure.savefig(pdf, metadata={"Creator": None, "Producer": None, "CreationDate": None})
        return png, pdf

    def svg(self) -> str:
        """The picture as an SVG document."""
        text = io.StringIO()
        self.figure.savefig(text, format="svg", facecolor="none", metadata=dict.fromkeys(("Date", "Creator")))
        return text.getvalue()
