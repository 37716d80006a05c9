"""A run as one self-contained HTML file: the moving scene, a legend, captions and a player."""

from __future__ import annotations

import base64
import gzip
import html
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from pydrake.geometry import Meshcat

from mala_drake.errors import BadInput
from mala_drake.reporting.scenery import View
from mala_drake.ward.furnishing.palette import FUNCTION_COLORS, floor_color
from mala_drake.ward.ward_map import Ward

FRAME_RATE = 10.0
"""Frames a second of simulation; the player interpolates between them."""

_MESSAGE = re.compile(
    r'fetch\("data:application/octet-binary;base64,([A-Za-z0-9+/=]+)"\)\s*\.then\(res => res\.arrayBuffer\(\)\)'
)
_COMPRESSED_FROM = 20_000  # Characters: smaller messages are left as they are.


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """A line of the legend: a CSS color and what it means."""

    color: str
    text: str


def ward_legend(ward: Ward) -> tuple[LegendEntry, ...]:
    """Which color is which category, with the names of its places, and what the floor's tint means."""
    entries = []
    for category, color in FUNCTION_COLORS.items():
        names = [place.name.replace("_", " ") for place in ward.places if place.category == category]
        if names:
            own = names == [category]
            entries.append(LegendEntry(_css(color), category if own else f"{category}: {', '.join(names)}"))
    if ward.zones:
        busiest = max(zone.level for zone in ward.zones)
        entries.append(LegendEntry(_css(floor_color(busiest)), "tinted floor: congestion, the deeper the busier"))
    return tuple(entries)


def _css(color: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in color)


def StartRecording(meshcat: Meshcat) -> None:
    """Starts to record what visualizers publish; it is shown live all the same.

    Args:
        meshcat: the one that the diagram's `MeshcatVisualizer` publishes to.
    """
    meshcat.DeleteRecording()
    meshcat.StartRecording(frames_per_second=FRAME_RATE, set_visualizations_while_recording=True)


def FinishRecording(
    meshcat: Meshcat,
    path: str | Path,
    *,
    title: str,
    view: View,
    legend: Sequence[LegendEntry] = (),
    captions: Iterable[tuple[float, str]] = (),
    follow: str = "",
    speed: int = 4,
) -> Path:
    """Writes what was recorded since `StartRecording` as a self-contained HTML file that opens without a server.

    Args:
        meshcat: has been given to `StartRecording`.
        path: of the file to write.
        title: shown above the legend.
        view: what the player's "Whole ward" button looks at; `SetScenery` sets the first view.
        legend: colors and their meaning.
        captions: (time in seconds, text), in any order: what is going on from that time on.
        follow: path in Meshcat of the body that the player can follow, for example
            `/drake/visualizer/care_robot/base`; empty for none.
        speed: of the player at the start, as a multiple of real time: 1, 2, 4, 8 or 16.

    Returns:
        The path.

    Raises:
        BadInput: when the file cannot be written.
    """
    meshcat.StopRecording()
    meshcat.PublishRecording()
    data = {
        "title": title,
        "legend": [asdict(entry) for entry in legend],
        "captions": sorted(captions, key=lambda caption: caption[0]),
        "view": asdict(view),
        "follow": follow,
        "speed": speed,
    }
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(_with_overlay(_compressed(meshcat.StaticHtml()), title, data), encoding="utf-8")
    except OSError as error:
        raise BadInput(str(path), f"cannot be written ({error.strerror})", "a writable file") from None
    return path


def _compressed(page: str) -> str:
    """The page with its large messages gzipped: an animation repeats itself, a fifth of it remains."""

    def shorter(match: re.Match[str]) -> str:
        message = match[1]
        if len(message) < _COMPRESSED_FROM:
            return match[0]
        packed = base64.b64encode(gzip.compress(base64.b64decode(message), mtime=0)).decode()
        return (
            f'fetch("data:application/octet-binary;base64,{packed}")\n    .then(res => '
            'new Response(res.body.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer())'
        )

    return _MESSAGE.sub(shorter, page)


def _with_overlay(page: str, title: str, data: object) -> str:
    overlay = Path(__file__).with_name("recording_overlay.html").read_text(encoding="utf-8")
    # "</" inside a script element could end it.
    embedded = json.dumps(data, ensure_ascii=False).replace("</", "<\\/")
    head, body, tail = page.rpartition("</body>")
    page = f'{head}<script type="application/json" id="recording">{embedded}</script>\n{overlay}{body}{tail}'
    return re.sub(
        r"<title>.*?</title>", lambda _: f"<title>{html.escape(title)}</title>", page, count=1, flags=re.DOTALL
    )
