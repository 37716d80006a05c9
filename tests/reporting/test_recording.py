"""A recording is one file that needs nothing else, and shows what was recorded."""

from __future__ import annotations

import base64
import gzip
import http.server
import json
import queue
import re
import shutil
import subprocess
import threading

import numpy as np
import pytest
from pydrake.geometry import Box, Meshcat, Rgba
from pydrake.math import RigidTransform

from mala_drake.errors import BadInput
from mala_drake.reporting import recording as mut
from mala_drake.reporting.scenery import View
from mala_drake.ward.ward_map import LoadWard

VIEW = View((0.0, -10.0, 8.0), (0.0, 0.0, 0.0))
MESSAGE = re.compile(r'base64,([A-Za-z0-9+/=]+)"\)\s*\.then\(res => (new|res)')


def record(path, **options) -> str:
    """A box that is driven along x for a minute, recorded; returns the file's text."""
    meshcat = Meshcat()
    meshcat.SetObject("/drake/robot", Box(1.0, 1.0, 1.0), Rgba(1.0, 0.0, 0.0, 1.0))
    mut.StartRecording(meshcat)
    for frame in range(601):
        meshcat.SetTransform("/drake/robot", RigidTransform([0.01 * frame, 0.0, 0.0]), time_in_recording=0.1 * frame)
    options = {"title": "A run", "view": VIEW, **options}
    return mut.FinishRecording(meshcat, path, **options).read_text(encoding="utf-8")


def messages(page: str) -> list[bytes]:
    """Everything that the page sends to its viewer, unpacked."""
    found = []
    for data, kind in MESSAGE.findall(page):
        raw = base64.b64decode(data)
        found.append(gzip.decompress(raw) if kind == "new" else raw)
    return found


def embedded_data(page: str) -> dict:
    return json.loads(re.search(r'id="recording">(.*?)</script>', page, re.DOTALL)[1])


def test_the_file_is_self_contained(tmp_path):
    page = record(tmp_path / "new folder" / "recording.html")
    overlay = page[page.index('id="recording"') :]
    assert not re.search(r"""(src|href)\s*=|@import|url\(|https?://""", overlay)
    assert not re.search(r"""<(script|link|img)[^>]+(src|href)=["']?https?:""", page)
    assert "<title>A run</title>" in page


def test_every_frame_is_in_the_file(tmp_path):
    (animation,) = [message for message in messages(record(tmp_path / "r.html")) if b"set_animation" in message]
    # Position and orientation, 601 keys each: "time" occurs once in a key.
    assert animation.count(b"\xa4time") == 2 * 601


def test_compression_keeps_every_message():
    meshcat = Meshcat()
    vertices = np.vstack((np.arange(6000.0), np.zeros(6000), np.arange(6000) % 7))
    meshcat.SetTriangleMesh("/drake/mesh", vertices, np.arange(6000).reshape(3, -1), Rgba(1.0, 0.0, 0.0, 1.0))
    page = meshcat.StaticHtml()
    packed = mut._compressed(page)
    assert len(packed) < len(page)
    assert messages(packed) == messages(page)
    assert messages(page)


def test_title_legend_and_captions_come_through_whatever_is_in_them(tmp_path):
    page = record(
        tmp_path / "r.html",
        title="<b> & </title>",
        legend=[mut.LegendEntry("#ff0000", "</script><script>alert(1)</script>")],
        captions=[(20.0, "deliver"), (0.0, "go to “pharmacy” </script>")],
        follow="/drake/robot",
        speed=8,
    )
    assert "<title>&lt;b&gt; &amp; &lt;/title&gt;</title>" in page
    data = embedded_data(page)
    assert data["title"] == "<b> & </title>"
    assert data["legend"] == [{"color": "#ff0000", "text": "</script><script>alert(1)</script>"}]
    assert data["captions"] == [[0.0, "go to “pharmacy” </script>"], [20.0, "deliver"]]
    assert (data["follow"], data["speed"]) == ("/drake/robot", 8)


def test_the_legend_of_a_ward_names_every_place_under_its_category():
    ward = LoadWard()
    entries = mut.ward_legend(ward)
    assert all(re.fullmatch("#[0-9a-f]{6}", entry.color) for entry in entries)
    for place in ward.places:
        (line,) = [entry.text for entry in entries if place.name.replace("_", " ") in re.split(": |, ", entry.text)]
        assert line.startswith(place.category)


def test_a_second_recording_does_not_contain_the_first(tmp_path):
    meshcat = Meshcat()
    for i, seconds in enumerate((6.0, 3.0)):
        mut.StartRecording(meshcat)
        for frame in range(int(10 * seconds)):
            meshcat.SetTransform("/drake/robot", RigidTransform(), time_in_recording=0.1 * frame)
        page = mut.FinishRecording(meshcat, tmp_path / f"{i}.html", title="", view=VIEW).read_text(encoding="utf-8")
        (animation,) = [message for message in messages(page) if b"set_animation" in message]
        assert animation.count(b"\xa4time") == 2 * 10 * seconds


def test_a_file_that_cannot_be_written_is_told_in_one_line(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BadInput, match="cannot be written"):
        record(tmp_path / "file" / "recording.html")


BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
FLAGS = ("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
TELL = """<script>setInterval(() => {
  const told = ["caption", "clock", "play"].map(id => document.getElementById(id).textContent);
  if (told[1].startsWith("0:25")) fetch("/told", {method: "POST", body: JSON.stringify(told)});
}, 100);</script></body>"""


@pytest.fixture
def told_by_browser(tmp_path):
    """A function that opens a page in a browser until the page tells what its player shows."""
    answers: queue.Queue[list[str]] = queue.Queue()
    pages: dict[str, bytes] = {}

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200 if self.path in pages else 404)
            self.end_headers()
            self.wfile.write(pages.get(self.path, b""))

        def do_POST(self) -> None:
            answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Keeps the test's output clean."""

    with http.server.ThreadingHTTPServer(("localhost", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()

        def ask(page: str, fragment: str) -> list[str]:
            pages["/recording.html"] = page.replace("</body>", TELL).encode()
            url = f"http://localhost:{server.server_port}/recording.html#{fragment}"
            command = [BROWSER, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", url]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as browser:
                try:
                    return answers.get(timeout=240)
                finally:
                    browser.terminate()

        yield ask
        server.shutdown()


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no Chromium")
def test_a_browser_shows_the_caption_of_the_moment(tmp_path, told_by_browser):
    captions = [(0.0, "first"), (20.0, "second"), (40.0, "third")]
    page = record(tmp_path / "recording.html", captions=captions, follow="/drake/robot")
    assert told_by_browser(page, "t=25.3") == ["second", "0:25 / 1:00", "Play"]
