"""The ward's map: places, furniture, congestion zones, and how they are read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import shapely

from mala_drake.configuration import read_yaml
from mala_drake.errors import BadInput
from mala_drake.messages import Shape
from mala_drake.resources import models_folder

CATEGORIES = ("home", "pharmacy", "supply", "charger", "bedside", "kitchen")


@dataclass(frozen=True, slots=True)
class Place:
    """A pose where the robot stands to do something. Metres and radians, world frame."""

    name: str
    x: float
    y: float
    yaw: float
    category: str


@dataclass(frozen=True, slots=True)
class Furniture:
    """Something solid on the floor. `serves` names the place it belongs to; `model` its looks in `furnishing/`."""

    name: str
    model: str
    x: float
    y: float
    height: float
    yaw: float = 0.0
    half_length: float = 0.0
    half_width: float = 0.0
    radius: float = 0.0
    serves: str = ""

    @property
    def shape(self) -> Shape:
        """Its outline seen from above."""
        return Shape(self.name, self.x, self.y, self.yaw, self.half_length, self.half_width, self.radius)


@dataclass(frozen=True, slots=True)
class Zone:
    """A congested part of the ward: level in (0, 1) and corners in metres."""

    name: str
    level: float
    polygon: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Ward:
    """The map. Planning data, control, sensing and pictures all read this one object."""

    name: str
    half_extent: float
    wall_half_thickness: float
    wall_height: float
    places: tuple[Place, ...]
    furniture: tuple[Furniture, ...]
    zones: tuple[Zone, ...]
    background_congestion: float

    @cached_property
    def place(self) -> Mapping[str, Place]:
        """Places by name."""
        return {place.name: place for place in self.places}

    @cached_property
    def furniture_of(self) -> Mapping[str, Furniture]:
        """The furniture that serves a place, by the place's name."""
        return {piece.serves: piece for piece in self.furniture if piece.serves}

    @cached_property
    def walls(self) -> tuple[Furniture, ...]:
        """The four outer walls; their inner faces are `wall_half_thickness` inside the extent."""
        length, thickness, height = self.half_extent, self.wall_half_thickness, self.wall_height
        sides = (
            ("east", length, 0.0, 1),
            ("north", 0.0, length, 0),
            ("west", -length, 0.0, 1),
            ("south", 0.0, -length, 0),
        )
        return tuple(
            Furniture(
                f"wall_{side}",
                "wall",
                x,
                y,
                height,
                half_length=thickness if upright else length,
                half_width=length if upright else thickness,
            )
            for side, x, y, upright in sides
        )

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        """Everything solid seen from above: furniture, partitions and outer walls."""
        return tuple(piece.shape for piece in (*self.furniture, *self.walls))


def _read(cls: type, data: Any, where: str) -> Any:
    """Builds the dataclass `cls` from the mapping `data`, naming the field that is wrong."""
    if not isinstance(data, dict):
        raise BadInput(where, f"{data!r}", "a mapping")
    known = {f.name: f for f in fields(cls)}
    for key in data:
        if key not in known:
            raise BadInput(f"{where}.{key}", "unknown key", "one of " + ", ".join(known))
    values = {}
    for name, value in data.items():
        kind = known[name].type
        if kind == "float":
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
                raise BadInput(f"{where}.{name}", f"{value!r}", "a finite number")
            value = float(value)
        elif kind == "str" and not isinstance(value, str):
            raise BadInput(f"{where}.{name}", f"{value!r}", "text")
        values[name] = value
    try:
        return cls(**values)
    except TypeError as error:
        raise BadInput(where, f"{str(error).split('__init__() ')[-1]}") from None


def _read_zone(data: Any, where: str) -> Zone:
    zone = _read(Zone, data, where)
    try:
        polygon = tuple((float(x), float(y)) for x, y in zone.polygon)
    except (TypeError, ValueError):
        raise BadInput(f"{where}.polygon", f"{zone.polygon!r}", "a list of [x, y] corners") from None
    if len(polygon) < 3 or not all(math.isfinite(value) for corner in polygon for value in corner):
        raise BadInput(f"{where}.polygon", f"{len(polygon)} corners", "at least 3 finite corners")
    if not (area := shapely.Polygon(polygon)).is_valid:
        raise BadInput(f"{where}.polygon", shapely.is_valid_reason(area), "corners in order round an area")
    if not 0 < zone.level < 1:
        raise BadInput(f"{where}.level", f"{zone.level}", "a level in (0, 1)")
    return Zone(zone.name, zone.level, polygon)


def LoadWard(path: str | Path | None = None) -> Ward:
    """Reads a ward map.

    Args:
        path: a YAML file; None is the hospital ward that comes with the package.

    Raises:
        BadInput: naming file, field, value and what was expected.
    """
    path = Path(path) if path is not None else models_folder() / "care_center.ward.yaml"
    where = path.name
    data = read_yaml(path)
    if not isinstance(data, dict):
        raise BadInput(where, "is not a mapping", "a ward map")
    data = dict(data)
    for key, reader in (
        ("places", lambda item, at: _read(Place, item, at)),
        ("furniture", lambda item, at: _read(Furniture, item, at)),
        ("zones", _read_zone),
    ):
        items = data.get(key, [])
        if not isinstance(items, list):
            raise BadInput(f"{where}: {key}", f"{items!r}", "a list")
        data[key] = tuple(reader(item, f"{where}: {key}[{i}]") for i, item in enumerate(items))
    ward: Ward = _read(Ward, data, where)
    _validate(ward, where)
    return ward


def _validate(ward: Ward, where: str) -> None:
    for key, named in (("places", ward.places), ("furniture", ward.furniture), ("zones", ward.zones)):
        names = [item.name for item in named]
        for name in names:
            if names.count(name) > 1:
                raise BadInput(f"{where}: {key}", f"{name!r} appears {names.count(name)} times", "unique names")
    if ward.half_extent <= 0 or ward.wall_half_thickness <= 0 or ward.wall_height <= 0:
        raise BadInput(f"{where}: half_extent, wall_half_thickness, wall_height", "not positive", "positive sizes")
    if not 0 < ward.background_congestion < 1:
        raise BadInput(f"{where}: background_congestion", f"{ward.background_congestion}", "a level in (0, 1)")
    for i, place in enumerate(ward.places):
        if place.category not in CATEGORIES:
            raise BadInput(f"{where}: places[{i}].category", f"{place.category!r}", "one of " + ", ".join(CATEGORIES))
        if max(abs(place.x), abs(place.y)) >= ward.half_extent:
            raise BadInput(f"{where}: places[{i}]", f"({place.x}, {place.y})", "a point inside the ward")
    for i, piece in enumerate(ward.furniture):
        if piece.serves and piece.serves not in ward.place:
            raise BadInput(f"{where}: furniture[{i}].serves", f"{piece.serves!r}", "the name of a place")
        if min(piece.half_length, piece.half_width, piece.radius) < 0 or piece.half_length + piece.radius <= 0:
            raise BadInput(f"{where}: furniture[{i}]", "no positive size", "half_length and half_width, or a radius")
