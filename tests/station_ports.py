"""Reading the ports of a station's systems."""

from __future__ import annotations


def read(station, context, system, port):
    """What an output port of a system says in a context of the station."""
    subsystem = station.GetSubsystemByName(system)
    return subsystem.GetOutputPort(port).Eval(subsystem.GetMyContextFromRoot(context))


def robot_state(station, context):
    return read(station, context, "plant", "care_robot_state")
