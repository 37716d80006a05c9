"""Reading Drake YAML into dataclasses, with every mistake told in one line."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

import yaml
from pydrake.common.yaml import yaml_load_typed

from mala_drake.errors import BadInput

T = TypeVar("T")

_LONGEST = 60  # Characters shown of a value that cannot be read.


def read_yaml(path: Path) -> Any:
    """What a YAML file holds: nested mappings, lists and plain values; None if it is empty.

    Raises:
        BadInput: the file cannot be read, is not YAML, or has a date or a whole number that is out of all bounds.
    """
    return _parsed(_text(path), path.name)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text in UTF-8"
        raise BadInput(str(path), f"cannot be read: {reason}", "a YAML file") from None


def _parsed(text: str, where: str) -> Any:
    try:
        return yaml.load(text, _Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f"{where}:{mark.line + 1}:{mark.column + 1}" if mark else where
        raise BadInput(place, f"not YAML: {getattr(error, 'problem', None) or error}") from None


class _Loader(yaml.SafeLoader):
    """Tells the place of a date that does not exist, and of a whole number that is larger than any float."""

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            value = super().construct_object(node, deep=deep)
            if isinstance(value, int):
                float(value)
        except (ValueError, OverflowError):
            kind, text = node.tag.rsplit(":", 1)[-1], str(node.value)
            shown = text if len(text) <= _LONGEST else text[:_LONGEST] + " ..."
            problem = f"{shown!r} is no {kind} that can be read"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark) from None
        return value


def load_typed(schema: type[T], path: str | Path, *, defaults: T) -> T:
    """Reads a YAML file into `schema`; keys that are missing keep their values in `defaults`.

    Raises:
        BadInput: the file cannot be read, is not YAML, or does not fit the schema.
    """
    path = Path(path)
    text = _text(path)
    data = _parsed(text, path.name)
    if data is None:
        return defaults
    return _typed(schema, data, text, where=path.name, defaults=defaults)


def typed(schema: type[T], data: Mapping[str, Any], *, where: str, defaults: T) -> T:
    """Puts nested mappings, as a file would hold them, into `schema`; keys that are missing keep their `defaults`.

    Args:
        schema: a dataclass.
        data: by field name.
        where: names the data in errors.
        defaults: not modified.

    Raises:
        BadInput: the data do not fit the schema.
    """
    return _typed(schema, data, yaml.safe_dump(dict(data)), where=where, defaults=copy.deepcopy(defaults))


def _typed(schema: type[T], data: Any, text: str, *, where: str, defaults: T) -> T:
    if not isinstance(data, dict):
        raise BadInput(where, f"a {type(data).__name__}", "a mapping of field names to values")
    _check_fields(schema, data, where)
    try:
        return yaml_load_typed(schema=schema, data=text, defaults=defaults)
    except (RuntimeError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise BadInput(where, re.sub(r"\s+", " ", str(error)).strip()) from None


def _check_fields(template: Any, data: Any, where: str) -> None:
    """Compares the mapping `data` with a dataclass, so that each error names file, field and value."""
    kinds = {item.name: item.type for item in fields(template)}
    if not isinstance(data, dict):
        raise BadInput(where, f"{data!r}", "a mapping with keys among " + ", ".join(kinds))
    for key, value in data.items():
        at = f"{where}: {key}" if ":" not in where else f"{where}.{key}"
        if key not in kinds:
            raise BadInput(at, "unknown key", "one of " + ", ".join(kinds))
        _check_value(kinds[key], value, at)


def _check_value(kind: Any, value: Any, at: str) -> None:
    if is_dataclass(kind):
        _check_fields(kind, value, at)
    elif get_origin(kind) is list:
        if not isinstance(value, list):
            raise BadInput(at, f"{value!r}", "a list")
        for i, element in enumerate(value):
            _check_value(get_args(kind)[0], element, f"{at}[{i}]")
    elif kind is float and isinstance(value, str) and _EXPONENTIAL.fullmatch(value):
        return
    elif kind in _EXPECTED:
        accepted, expected = _EXPECTED[kind]
        # A bool is an int to Python, but not to a reader of the file.
        if not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool):
            raise BadInput(at, f"{value!r}", expected)


# PyYAML takes 1e-3 for text, unlike YAML 1.2; Drake's reader makes a number of it.
_EXPONENTIAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)[eE][+-]?\d+")

_EXPECTED: dict[Any, tuple[tuple[type, ...], str]] = {
    bool: ((bool,), "true or false"),
    int: ((int,), "a whole number"),
    float: ((int, float), "a number"),
    str: ((str,), "text"),
}
