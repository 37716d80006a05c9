"""The drawn graph against the diagram's own connections."""

from __future__ import annotations

import re
import shutil

import pytest
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder, ConstantVectorSource, Gain, LogVectorOutput

from mala_drake.errors import BadInput
from mala_drake.reporting import diagram_graph as mut


def nested_diagram() -> Diagram:
    """source -> inner(gain, gain) -> adder, whose second input and whose sum are the whole diagram's ports."""
    inside = DiagramBuilder()
    first = inside.AddNamedSystem("first", Gain(2.0, 1))
    second = inside.AddNamedSystem("second", Gain(3.0, 1))
    inside.Connect(first.get_output_port(), second.get_input_port())
    inside.ExportInput(first.get_input_port(), "command")
    inside.ExportOutput(second.get_output_port(), "amplified")
    inner = inside.Build()
    inner.set_name("inner")

    builder = DiagramBuilder()
    source = builder.AddNamedSystem("source", ConstantVectorSource([1.0]))
    builder.AddSystem(inner)
    adder = builder.AddNamedSystem("adder", Adder(2, 1))
    builder.Connect(source.get_output_port(), inner.GetInputPort("command"))
    builder.Connect(inner.GetOutputPort("amplified"), adder.get_input_port(0))
    builder.ExportInput(adder.get_input_port(1), "disturbance")
    builder.ExportOutput(adder.get_output_port(), "total")
    diagram = builder.Build()
    diagram.set_name("outer")
    return diagram


def test_mermaid_shows_the_systems_inside_nested_diagrams_and_who_feeds_whom():
    assert mut.mermaid(nested_diagram()) == (
        "flowchart LR\n"
        '    d_0["source<br/><small>ConstantVectorSource</small>"]\n'
        '    subgraph d_1["inner"]\n'
        '        d_1_0["first<br/><small>Gain</small>"]\n'
        '        d_1_1["second<br/><small>Gain</small>"]\n'
        "    end\n"
        '    d_2["adder<br/><small>Adder</small>"]\n'
        '    in_0(["disturbance"])\n'
        '    out_0(["total"])\n'
        '    d_0 -->|"y0 → u0"| d_1_0\n'
        '    d_1_0 -->|"y0 → u0"| d_1_1\n'
        '    d_1_1 -->|"y0 → u0"| d_2\n'
        '    d_2 -->|"sum"| out_0\n'
        '    in_0 -->|"u1"| d_2\n'
    )


def test_mermaid_closes_diagrams_below_the_depth():
    shallow = mut.mermaid(nested_diagram(), max_depth=1)
    assert '    d_1["inner<br/><small>Diagram</small>"]\n' in shallow
    assert '    d_0 -->|"y0 → command"| d_1\n' in shallow
    assert "Gain" not in shallow
    assert mut.mermaid(nested_diagram(), max_depth=0) == 'flowchart LR\n    d["outer"]\n'


def test_mermaid_has_an_edge_exactly_where_the_diagram_has_a_connection():
    builder = DiagramBuilder()
    gains = [builder.AddNamedSystem(f"gain_{i}", Gain(1.0, 1)) for i in range(8)]
    for i in range(1, 8):
        builder.Connect(gains[(7 * i + 3) % i].get_output_port(), gains[i].get_input_port())
    diagram = builder.Build()
    drawn = set(re.findall(r"^    d_(\d) -->.* d_(\d)$", mut.mermaid(diagram), re.MULTILINE))
    connected = {
        (str(i), str(j))
        for i in range(8)
        for j in range(8)
        if diagram.AreConnected(gains[i].get_output_port(), gains[j].get_input_port())
    }
    assert len(connected) == 7
    assert drawn == connected


def test_quotes_in_names_do_not_end_the_label():
    builder = DiagramBuilder()
    builder.AddNamedSystem('a "good" gain', Gain(1.0, 1))
    assert '["a #quot;good#quot; gain<br/>' in mut.mermaid(builder.Build())


@pytest.mark.parametrize("suffix", [".dot", ".md"])
def test_equal_diagrams_give_equal_files(tmp_path, suffix):
    # Kept alive, the diagrams lie at different addresses, by which Drake orders some of its text.
    diagrams = [nested_diagram() for _ in range(10)]
    texts = [mut.write_graph(diagram, tmp_path / f"{i}{suffix}").read_text() for i, diagram in enumerate(diagrams)]
    assert len(set(texts)) == 1
    assert "ConstantVectorSource" in texts[0]


def test_renumbering_leaves_names_alone():
    """A system or port may be called like one of Graphviz' nodes."""
    builder = DiagramBuilder()
    gain = builder.AddNamedSystem("s123", Gain(1.0, 1))
    builder.ExportInput(gain.get_input_port(), "s77")
    LogVectorOutput(gain.get_output_port(), builder).set_name("cluster9")
    text = mut.graphviz_source(builder.Build())
    for name in ("name=s123\n", ">s77<", "name=cluster9\n"):
        assert name in text


def test_markdown_has_the_flowchart_in_a_mermaid_block(tmp_path):
    text = mut.write_graph(nested_diagram(), tmp_path / "deep" / "graph.md").read_text(encoding="utf-8")
    assert text.startswith("# outer\n\n```mermaid\nflowchart LR\n")
    assert text.endswith("```\n")


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize(("suffix", "magic"), [(".svg", b"<?xml"), (".png", b"\x89PNG")])
def test_pictures_are_drawn_where_graphviz_is(tmp_path, suffix, magic):
    assert mut.write_graph(nested_diagram(), tmp_path / f"graph{suffix}").read_bytes().startswith(magic)


def test_a_picture_without_graphviz_names_the_way_out(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BadInput, match=r"dot.*\.md") as caught:
        mut.write_graph(nested_diagram(), tmp_path / "graph.svg")
    assert "\n" not in str(caught.value)


def test_what_cannot_be_written_is_told(tmp_path):
    with pytest.raises(BadInput, match=r"\.pdf"):
        mut.write_graph(nested_diagram(), tmp_path / "graph.pdf")
    with pytest.raises(BadInput, match="max_depth: -1"):
        mut.write_graph(nested_diagram(), tmp_path / "graph.md", max_depth=-1)
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BadInput, match="cannot be written"):
        mut.write_graph(nested_diagram(), tmp_path / "file" / "graph.md")
