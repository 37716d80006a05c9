"""What all messages have in common: a value that does not change, so that a copy is free."""

from __future__ import annotations

from typing import Any

Atom = tuple[str, ...]
"""A ground atom as in PDDL, for example `("at", "robot1", "home")`."""


class Message:
    """A value on an abstract port: immutable, so a copy is the value itself."""

    __slots__ = ()

    def __deepcopy__(self, memo: dict[int, Any]) -> Message:
        return self

    def __copy__(self) -> Message:
        return self
