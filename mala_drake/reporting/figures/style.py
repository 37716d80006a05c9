"""How every figure looks: one set of colors, one type size, no more ink than needed.

Colors are those of Okabe and Ito, which people with any color vision can tell apart. A profile has the color of the
criterion that matters most to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import TYPE_CHECKING

from mala_drake.patient.profiles import PROFILES
from mala_drake.preferences import CRITERIA

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, MUTED, FAINT, PAPER = "#1c2127", "#66707c", "#dfe3e8", "#fdfefe"
"""Text, secondary text, grid lines, and the ground that everything stands on."""

FURNITURE, WALL, FLOOR, BUSY = "#c3cad3", "#8a94a1", "#f3f5f7", "#6a51a3"
"""Of floor plans; the color of congestion is unlike that of any patient."""

CRITERION_COLORS: Mapping[str, str] = MappingProxyType(
    dict(zip(CRITERIA, ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"), strict=True))
)

PLACE_COLORS: Mapping[str, str] = MappingProxyType(
    {
        "home": "#5b6673",
        "pharmacy": "#0f7a49",
        "supply": "#2a6bc4",
        "charger": "#8f7000",
        "kitchen": "#b45500",
        "bedside": "#c03a72",
    }
)
"""By kind of place: the hues of the furniture in the 3-D ward, dark enough for text."""

WIDTH = 7.6
"""Inches of a figure as wide as the page."""

_OTHERS = ("#56b4e9", "#8c6d31", "#7570b3")  # Patients that are not among the five.

_SETTINGS = {
    "font.family": "DejaVu Sans",  # Comes with matplotlib, so that pictures are the same everywhere.
    "font.size": 7.5,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 7.5,
    "axes.labelcolor": MUTED,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": MUTED,
    "ytick.labelcolor": MUTED,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "text.color": INK,
    "figure.facecolor": PAPER,
    "savefig.facecolor": PAPER,
    "lines.linewidth": 1.6,
    "lines.solid_capstyle": "round",
    "svg.fonttype": "path",
    "svg.hashsalt": "mala_drake",
    "pdf.fonttype": 42,
    "path.simplify": True,
}


@contextmanager
def styled() -> Iterator[None]:
    """Draws and writes what is made inside in the style of the reports, whatever the user's own settings are."""
    import matplotlib
    from matplotlib import rc_context

    with rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_SETTINGS)
        yield


def profile_color(profile: str) -> str:
    """The color of a patient."""
    weights = PROFILES.get(profile)
    if weights is None:
        return _OTHERS[sum(profile.encode()) % len(_OTHERS)]
    return CRITERION_COLORS[CRITERIA[max(range(len(CRITERIA)), key=weights.__getitem__)]]


def ink_on(color: str) -> str:
    """Black or white, whichever is easier to read on a color (by its relative luminance, as in WCAG 2)."""
    from matplotlib.colors import to_rgb

    linear = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in to_rgb(color))
    luminance = sum(share * part for share, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    return "#000000" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "#ffffff"


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of this size in inches, laid out by matplotlib's constrained layout."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def grid_of_axes(figure: Figure, count: int, columns: int, **sharing: bool) -> list[Axes]:
    """Axes for small multiples, row by row; those of the grid that are not needed are taken away."""
    rows = -(-count // columns)
    axes = figure.subplots(rows, columns, squeeze=False, **sharing).ravel().tolist()
    for unused in axes[count:]:
        unused.remove()
    return axes[:count]
