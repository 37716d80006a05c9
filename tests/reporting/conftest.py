"""A small diagram whose graph is known by heart."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Adder, ConstantVectorSource, Gain


def _nested_diagram() -> Diagram:
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


@pytest.fixture
def make_nested_diagram() -> Callable[[], Diagram]:
    """Each call builds the diagram anew."""
    return _nested_diagram
