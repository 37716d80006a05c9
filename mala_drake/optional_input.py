"""Reading an input port that need not be connected."""

from __future__ import annotations

from typing import TypeVar

from pydrake.systems.framework import Context, InputPort

Told = TypeVar("Told")


def told(port: InputPort, context: Context, nothing: Told) -> Told:
    """The value of an abstract input port, or `nothing` when it is neither connected nor fixed.

    Args:
        port: of the system whose context is given.
        context: of that system.
        nothing: the message of whoever has nothing to say.
    """
    return port.Eval(context) if port.HasValue(context) else nothing
