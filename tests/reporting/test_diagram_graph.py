"""Files of the graph: their forms, and what is told when they cannot be written."""

from __future__ import annotations

import shutil

import pytest

from mala_drake.errors import BadInput
from mala_drake.reporting import diagram_graph as mut


def test_graphviz_source_is_written_as_it_is(tmp_path, make_nested_diagram):
    text = mut.write_graph(make_nested_diagram(), tmp_path / "graph.dot").read_text(encoding="utf-8")
    assert text == mut.graphviz_source(make_nested_diagram())
    assert text.startswith("digraph")


def test_markdown_has_the_flowchart_in_a_mermaid_block(tmp_path, make_nested_diagram):
    text = mut.write_graph(make_nested_diagram(), tmp_path / "deep" / "graph.md").read_text(encoding="utf-8")
    assert text.startswith("# outer\n\n```mermaid\nflowchart LR\n")
    assert text.endswith("```\n")


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize(("suffix", "magic"), [(".svg", b"<?xml"), (".png", b"\x89PNG")])
def test_pictures_are_drawn_where_graphviz_is(tmp_path, suffix, magic, make_nested_diagram):
    assert mut.write_graph(make_nested_diagram(), tmp_path / f"graph{suffix}").read_bytes().startswith(magic)


def test_a_picture_without_graphviz_names_the_way_out(tmp_path, monkeypatch, make_nested_diagram):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BadInput, match=r"dot.*\.md") as caught:
        mut.write_graph(make_nested_diagram(), tmp_path / "graph.svg")
    assert "\n" not in str(caught.value)


def test_what_cannot_be_written_is_told(tmp_path, make_nested_diagram):
    with pytest.raises(BadInput, match=r"\.pdf"):
        mut.write_graph(make_nested_diagram(), tmp_path / "graph.pdf")
    with pytest.raises(BadInput, match="max_depth: -1"):
        mut.write_graph(make_nested_diagram(), tmp_path / "graph.md", max_depth=-1)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BadInput, match="cannot be written"):
        mut.write_graph(make_nested_diagram(), tmp_path / "file" / "graph.md")
