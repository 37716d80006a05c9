"""The diagram written as Graphviz source, Mermaid in Markdown, or a picture."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from pydrake.systems.framework import Diagram

from mala_drake.errors import BadInput
from mala_drake.reporting.graphviz import graphviz_source
from mala_drake.reporting.mermaid import mermaid

FORMATS = (".dot", ".md", ".svg", ".png")


def write_graph(diagram: Diagram, path: str | Path, max_depth: int | None = None) -> Path:
    """Writes the graph of a diagram's systems and connections; the same diagram gives the same text.

    Args:
        diagram: any diagram.
        path: its suffix selects the form: .dot, .md (Mermaid), .svg or .png.
        max_depth: how many levels of nested diagrams are opened; None opens all.

    Returns:
        The path.

    Raises:
        BadInput: for another suffix, a negative depth, a file that cannot be written, or a picture when Graphviz'
            `dot` is not installed.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise BadInput(str(path), f"no such form {suffix!r}", "a file name ending in " + ", ".join(FORMATS))
    if max_depth is not None and max_depth < 0:
        raise BadInput("max_depth", f"{max_depth}", "0 or more levels")
    if suffix == ".md":
        content = f"# {diagram.get_name() or 'Diagram'}\n\n```mermaid\n{mermaid(diagram, max_depth)}```\n".encode()
    else:
        source = graphviz_source(diagram, max_depth)
        content = source.encode() if suffix == ".dot" else _drawn(source, suffix[1:], path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise BadInput(str(path), f"cannot be written ({error.strerror})", "a writable file") from None
    return path


def _drawn(source: str, form: str, path: Path) -> bytes:
    program = shutil.which("dot")
    if program is None:
        raise BadInput(
            str(path),
            "drawing needs Graphviz' program `dot`, which is not on the PATH",
            "Graphviz to be installed, or a file name ending in .md or .dot",
        )
    done = subprocess.run([program, f"-T{form}"], input=source.encode(), capture_output=True, check=False)
    if done.returncode != 0:
        reason = done.stderr.decode(errors="replace").strip().splitlines()
        raise BadInput(str(path), f"`dot` failed ({reason[-1] if reason else done.returncode})", "a graph it can draw")
    return done.stdout
