"""The flowchart against the diagram's own connections."""

from __future__ import annotations

import re

from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Gain

from mala_drake.reporting.mermaid import mermaid


def test_mermaid_shows_the_systems_inside_nested_diagrams_and_who_feeds_whom(make_nested_diagram):
    assert mermaid(make_nested_diagram()) == (
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


def test_mermaid_closes_diagrams_below_the_depth(make_nested_diagram):
    shallow = mermaid(make_nested_diagram(), max_depth=1)
    assert '    d_1["inner<br/><small>Diagram</small>"]\n' in shallow
    assert '    d_0 -->|"y0 → command"| d_1\n' in shallow
    assert "Gain" not in shallow
    assert mermaid(make_nested_diagram(), max_depth=0) == 'flowchart LR\n    d["outer"]\n'


def test_mermaid_has_an_edge_exactly_where_the_diagram_has_a_connection():
    builder = DiagramBuilder()
    gains = [builder.AddNamedSystem(f"gain_{i}", Gain(1.0, 1)) for i in range(8)]
    for i in range(1, 8):
        builder.Connect(gains[(7 * i + 3) % i].get_output_port(), gains[i].get_input_port())
    diagram = builder.Build()
    drawn = set(re.findall(r"^    d_(\d) -->.* d_(\d)$", mermaid(diagram), re.MULTILINE))
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
    assert '["a #quot;good#quot; gain<br/>' in mermaid(builder.Build())
