"""What may stand in the fields of a record that is read from JSON, said by composing a few forms.

A form takes a value and where it is, for errors, and returns the value as it is kept; it raises `BadInput` for another
one than it is about.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from mala_drake.errors import BadInput

Form = Callable[[Any, str], Any]

_LONGEST = 60  # Characters of a wrong value that are shown.


def text(value: Any, where: str) -> str:
    """Any text."""
    return value if isinstance(value, str) else _refuse(value, where, "text")


def action(value: Any, where: str) -> str:
    """An action as a plan has it: its name, then its objects."""
    return value if text(value, where).strip("()").split() else _refuse(value, where, "(name object ...)")


def flag(value: Any, where: str) -> bool:
    """Yes or no."""
    return value if isinstance(value, bool) else _refuse(value, where, "true or false")


def whole(value: Any, where: str) -> int:
    """A whole number."""
    return value if isinstance(value, int) and not isinstance(value, bool) else _refuse(value, where, "a whole number")


def number(value: Any, where: str) -> float:
    """A number that is finite."""
    told = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= sys.float_info.max
    return value if told else _refuse(value, where, "a finite number")


def positive(value: Any, where: str) -> float:
    """A number above 0."""
    return value if number(value, where) > 0.0 else _refuse(value, where, "a number above 0")


def measured(value: Any, where: str) -> float:
    """A number; what was written as null because it was not finite is NaN again."""
    return math.nan if value is None else number(value, where)


def name_with_unit(value: Any, where: str) -> str:
    """A name of a time, which ends in its unit."""
    told = re.fullmatch(r".+_m?s", text(value, where))
    return value if told else _refuse(value, where, "a name that ends in _s or _ms")


def or_null(form: Form) -> Form:
    """The form, or null, which stays None."""
    return lambda value, where: None if value is None else form(value, where)


def list_of(form: Form, *lengths: int) -> Form:
    """A list whose entries have the form.

    Args:
        form: of each entry.
        lengths: that it may have; any if none is given.
    """
    expected = "a list" + (f" of {' or '.join(map(str, lengths))}" if lengths else "")

    def read(value: Any, where: str) -> list[Any]:
        if not isinstance(value, list) or (lengths and len(value) not in lengths):
            _refuse(value, where, expected)
        return [form(item, f"{where}[{i}]") for i, item in enumerate(value)]

    return read


def mapping_to(form: Form, *, key: Form = text) -> Form:
    """An object whose values have the form, under any keys that have the form `key`."""

    def read(value: Any, where: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            _refuse(value, where, "an object")
        return {key(name, where): form(item, f"{where}.{name}") for name, item in value.items()}

    return read


def entry(needed: Mapping[str, Form], others: Mapping[str, Form] | None = None) -> Form:
    """An object with keys that are known; those that a newer version may have added are kept as they are.

    Args:
        needed: what has to be there, by key.
        others: what may be there.
    """
    forms = {**needed, **(others or {})}

    def read(value: Any, where: str) -> dict[str, Any]:
        missing = [key for key in needed if key not in value] if isinstance(value, dict) else list(needed)
        if missing:
            _refuse(value, where, f"an object with {', '.join(needed)}")
        return {key: forms[key](item, f"{where}.{key}") if key in forms else item for key, item in value.items()}

    return read


def _refuse(value: Any, where: str, expected: str) -> NoReturn:
    found = json.dumps(value, ensure_ascii=False)
    raise BadInput(where, found if len(found) <= _LONGEST else found[:_LONGEST] + " ...", expected)
