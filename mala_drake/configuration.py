"""Reading Drake YAML into dataclasses, with every mistake told in one line."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydrake.common.yaml import yaml_load_typed

from mala_drake.errors import BadInput

T = TypeVar("T")


def load_typed(schema: type[T], path: str | Path, *, defaults: T) -> T:
    """Reads a YAML file into `schema`; keys that are missing keep their values in `defaults`.

    Raises:
        BadInput: the file cannot be read, is not YAML, or does not fit the schema.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text in UTF-8"
        raise BadInput(str(path), f"cannot be read: {reason}", "a YAML file") from None
    try:
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f"{path.name}:{mark.line + 1}:{mark.column + 1}" if mark else path.name
        raise BadInput(place, f"not YAML: {getattr(error, 'problem', None) or error}") from None
    if data is None:
        return defaults
    if not isinstance(data, dict):
        raise BadInput(path.name, f"a {type(data).__name__}", "a mapping of field names to values")
    _check_fields(defaults, data, path.name)
    try:
        return yaml_load_typed(schema=schema, data=text, defaults=defaults)
    except (RuntimeError, TypeError, ValueError, AttributeError) as error:
        raise BadInput(path.name, re.sub(r"\s+", " ", str(error)).strip()) from None


def _check_fields(template: Any, data: Any, where: str) -> None:
    """Compares the mapping `data` with a dataclass instance, so that each error names file, field and value."""
    fields = vars(template)
    if not isinstance(data, dict):
        raise BadInput(where, f"{data!r}", "a mapping with keys among " + ", ".join(fields))
    for key, value in data.items():
        at = f"{where}: {key}" if ":" not in where else f"{where}.{key}"
        if key not in fields:
            raise BadInput(at, "unknown key", "one of " + ", ".join(fields))
        default = fields[key]
        if hasattr(default, "__dataclass_fields__"):
            _check_fields(default, value, at)
        elif isinstance(default, bool):
            if not isinstance(value, bool):
                raise BadInput(at, f"{value!r}", "true or false")
        elif isinstance(default, int) and (isinstance(value, bool) or not isinstance(value, int)):
            raise BadInput(at, f"{value!r}", "a whole number")
        elif isinstance(default, float) and (isinstance(value, bool) or not isinstance(value, (int, float))):
            raise BadInput(at, f"{value!r}", "a number")
        elif isinstance(default, str) and not isinstance(value, str):
            raise BadInput(at, f"{value!r}", "text")
        elif isinstance(default, list) and not isinstance(value, list):
            raise BadInput(at, f"{value!r}", "a list")
