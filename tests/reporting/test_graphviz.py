"""Drake's Graphviz text, tidied up without losing what matters."""

from __future__ import annotations

import re

from pydrake.systems.framework import DiagramBuilder, LeafSystem
from pydrake.systems.primitives import ConstantVectorSource, Gain, LogVectorOutput

from mala_drake.reporting.graphviz import graphviz_source


def test_renumbering_leaves_names_alone():
    """A system or port may be called like one of Graphviz' nodes."""
    builder = DiagramBuilder()
    gain = builder.AddNamedSystem("s123", Gain(1.0, 1))
    builder.ExportInput(gain.get_input_port(), "s77")
    LogVectorOutput(gain.get_output_port(), builder).set_name("cluster9")
    text = graphviz_source(builder.Build())
    for name in ("name=s123\n", ">s77<", "name=cluster9\n"):
        assert name in text


def test_every_connection_is_drawn_between_ports_that_are_shown(make_nested_diagram):
    text = graphviz_source(make_nested_diagram())
    edges = re.findall(r"^(s\w+):(\w+):e -> (s\w+):(\w+):w", text, re.MULTILINE)
    # Three connections and two exports outside, one connection and two exports inside.
    assert len(edges) == 7
    for source, output, target, input_ in edges:
        for node, port in ((source, output), (target, input_)):
            table = text[text.index(f"\n{node} [shape=none") :].split("</TABLE>")[0]
            assert f'PORT="{port}"' in table


class Doubler(LeafSystem):
    """A system whose class has a module, as all systems written in Python."""

    def __init__(self) -> None:
        super().__init__()
        for name in ("first", "second", "third"):
            self.DeclareVectorInputPort(name, 1)
        self.DeclareVectorOutputPort("double", 1, lambda _, output: output.SetZero())


def test_ports_without_connection_and_modules_of_classes_are_left_out():
    builder = DiagramBuilder()
    source = builder.AddNamedSystem("source", ConstantVectorSource([1.0]))
    doubler = builder.AddNamedSystem("doubler", Doubler())
    builder.Connect(source.get_output_port(), doubler.GetInputPort("second"))
    diagram = builder.Build()
    assert ".Doubler</B>" in diagram.GetGraphvizString()
    text = graphviz_source(diagram)
    assert "<B>Doubler</B>" in text
    assert ">second<" in text
    assert not re.search(r">(first|third|double)<", text)


def test_text_is_the_same_wherever_objects_lie_in_memory(make_nested_diagram):
    diagrams = [make_nested_diagram() for _ in range(10)]  # Kept alive, they lie at different addresses.
    assert len({graphviz_source(diagram) for diagram in diagrams}) == 1
