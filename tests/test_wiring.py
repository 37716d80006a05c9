"""What is connected to what, by name alone."""

from __future__ import annotations

import pytest
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from mala_drake import wiring as mut


class Block(LeafSystem):
    """Has these inputs and outputs, each output the sum of the inputs and 1."""

    def __init__(self, inputs=(), outputs=()):
        super().__init__()
        ports = [self.DeclareVectorInputPort(name, 1) for name in inputs]

        def total(context, output):
            output.SetFromVector([1.0 + sum(port.Eval(context)[0] for port in ports)])

        for name in outputs:
            self.DeclareVectorOutputPort(name, 1, total)


@pytest.fixture
def add():
    """Adds blocks to one builder, and names what is connected."""

    class Bench:
        def __init__(self):
            self.builder = DiagramBuilder()

        def __call__(self, name, inputs=(), outputs=()):
            return self.builder.AddNamedSystem(name, Block(inputs, outputs))

        def connections(self):
            return {
                (
                    source.get_name(),
                    source.get_output_port(i).get_name(),
                    target.get_name(),
                    target.get_input_port(j).get_name(),
                )
                for (target, j), (source, i) in self.builder.connection_map().items()
            }

    return Bench()


def test_an_output_goes_to_the_inputs_of_its_name(add):
    source, first, second = add("source", outputs="ab"), add("first", "ab"), add("second", "a")
    mut.Wiring(add.builder).wire(source, "a", first, second)
    assert add.connections() == {("source", "a", "first", "a"), ("source", "a", "second", "a")}


def test_a_system_that_has_no_such_port_is_a_mistake(add):
    source, other = add("source", outputs="a"), add("other", "b")
    wiring = mut.Wiring(add.builder)
    for name in "ab":
        with pytest.raises(RuntimeError, match="port"):
            wiring.wire(source, name, other)


def test_a_listener_hears_what_it_has_inputs_for(add):
    listener, one, other = add("listener", "abc"), add("one", "c", "ax"), add("other", (), "by")
    mut.Wiring(add.builder).listen(listener, one, other)
    assert add.connections() == {("one", "a", "listener", "a"), ("other", "b", "listener", "b")}


def test_a_fan_out_reaches_every_input_of_the_name_that_is_still_open(add):
    source, own, _ = add("source", outputs="b"), add("own", outputs="a"), add("open", "ab")
    taken, exported = add("taken", "a"), add("exported", "a")
    wiring = mut.Wiring(add.builder)
    wiring.wire(own, "a", taken)
    add.builder.ExportInput(exported.GetInputPort("a"))
    wiring.fan_out("a", source.GetOutputPort("b"))
    assert add.connections() == {("own", "a", "taken", "a"), ("source", "b", "open", "a")}
