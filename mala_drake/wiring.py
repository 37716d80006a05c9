"""Connecting systems by the names of their ports, for diagrams in which a name means one thing."""

from __future__ import annotations

from typing import Any

from pydrake.systems.framework import DiagramBuilder


class Wiring:
    """Connects the systems of one builder."""

    def __init__(self, builder: DiagramBuilder) -> None:
        self._builder = builder

    def wire(self, source: Any, name: str, *targets: Any) -> None:
        """Connects the output port `name` of a system to the input ports of the same name that others have."""
        for target in targets:
            self._builder.Connect(source.GetOutputPort(name), target.GetInputPort(name))

    def listen(self, listener: Any, *sources: Any) -> None:
        """Connects the inputs of a system to the outputs of the same names that others have."""
        for source in sources:
            for port in map(source.get_output_port, range(source.num_output_ports())):
                if listener.HasInputPort(port.get_name()):
                    self._builder.Connect(port, listener.GetInputPort(port.get_name()))

    def fan_out(self, name: str, port: Any) -> None:
        """Connects an output port to every input port called `name` in the diagram that is still open."""
        for system in self._builder.GetSystems():
            if system.HasInputPort(name) and not self._builder.IsConnectedOrExported(system.GetInputPort(name)):
                self._builder.Connect(port, system.GetInputPort(name))
