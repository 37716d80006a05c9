"""The furnished ward as Drake sees it: models and the directives that place them, both derived from the map."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import degrees, hypot

from shapely.geometry.base import BaseGeometry

from mala_drake.errors import BadInput
from mala_drake.ward.furnishing import BUILDERS, ROUND_MODELS
from mala_drake.ward.furnishing.flat import obj_text
from mala_drake.ward.furnishing.floor import floor_parts, floor_regions, floor_tiles, standing_mark
from mala_drake.ward.furnishing.parts import Part, Size, text_of, urdf
from mala_drake.ward.furnishing.signs import floor_sign, place_mark, sign_heights, sign_letters, standing_sign
from mala_drake.ward.furnishing.storage import LEDGE_DEPTH, LEDGE_HEIGHT
from mala_drake.ward.ward_map import Furniture, Place, Ward

__all__ = [
    "FLOOR",
    "LEDGE_DEPTH",
    "LEDGE_HEIGHT",
    "PACKAGE_FOLDER",
    "WardModel",
    "ward_directives",
    "ward_files",
    "ward_models",
]

PACKAGE_FOLDER = "ward"
"""Folder of the ward's models inside `package://mala_drake/`."""

_NAME = re.compile(r"\w[\w .-]*")  # What can be part of a file's name and of a directive.
_MAT_OFFSET = 1.2  # Metres.

FLOOR = "floor"
"""Name of the floor's model."""


@dataclass(frozen=True, slots=True)
class WardModel:
    """A model and where its link `base` is welded: metres and radians, world frame, z on the floor."""

    name: str
    file: str  # In PACKAGE_FOLDER.
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


def _uri(file: str) -> str:
    return f"package://mala_drake/{PACKAGE_FOLDER}/{file}"


def _furniture_file(piece: Furniture) -> str:
    """Named by model and full sizes in millimetres, so that a name means one content."""
    sizes = (2 * piece.half_length, 2 * piece.half_width) if piece.radius == 0 else (2 * piece.radius,)
    return f"{piece.model}_" + "x".join(text_of(1000 * size) for size in (*sizes, piece.height)) + ".urdf"


def _floor_stem(ward: Ward) -> str:
    regions = repr((ward.half_extent, ward.wall_half_thickness, [(zone.level, zone.polygon) for zone in ward.zones]))
    return "floor_" + hashlib.sha256(regions.encode()).hexdigest()[:8]


def _sign_position(place: Place, piece: Furniture) -> tuple[float, float]:
    """Towards the far side of the furniture as seen from the place, so that the pole is out of the arm's way."""
    distance = hypot(piece.x - place.x, piece.y - place.y)
    back = 0.8 * min(piece.half_length, piece.half_width) / distance if distance > 0 else 0.0
    return piece.x + back * (piece.x - place.x), piece.y + back * (piece.y - place.y)


def _check(piece: Furniture) -> None:
    where = f"furniture {piece.name!r}"
    if piece.model not in BUILDERS:
        raise BadInput(f"{where}: model", f"{piece.model!r}", "one of " + ", ".join(sorted(BUILDERS)))
    if piece.model in ROUND_MODELS and (piece.half_length or piece.half_width or not piece.radius):
        raise BadInput(where, f"model {piece.model} has half sizes", "a radius only, for it is round")
    if piece.model not in ROUND_MODELS and (piece.radius or not piece.half_length or not piece.half_width):
        raise BadInput(where, f"model {piece.model} has a radius", "half_length and half_width only")
    if piece.height <= 0:
        raise BadInput(f"{where}: height", f"{piece.height}", "a positive height")
    try:
        _furniture_parts(piece)
    except ValueError as error:
        raise BadInput(where, f"model {piece.model} of this size and height has {error}", "a larger one") from None


def ward_models(ward: Ward) -> tuple[WardModel, ...]:
    """Everything to be welded to the world: floor, outer walls, furniture and the signs of the places.

    Raises:
        BadInput: for a model that does not exist or cannot have the size, and for two things of one name.
    """
    pieces = (*ward.walls, *ward.furniture)
    for name in (*(place.name for place in ward.places), *(piece.name for piece in pieces)):
        if not _NAME.fullmatch(name):
            raise BadInput(f"ward {ward.name!r}", f"the name {name!r}", "letters, digits, spaces and the signs _ . -")
    for piece in pieces:
        _check(piece)
    models = [WardModel(FLOOR, _floor_stem(ward) + ".urdf")]
    models += [WardModel(piece.name, _furniture_file(piece), piece.x, piece.y, piece.yaw) for piece in pieces]
    sign_files, positions = _sign_files(ward), _standing_signs(ward)
    for place in ward.places:
        # A mat lies in front of the place, seen from the south, so that a robot at the place does not cover its name.
        x, y = positions.get(place.name, (place.x, place.y - _MAT_OFFSET))
        models.append(WardModel(f"sign_{place.name}", sign_files[place.name][0], x, y))
        models.append(WardModel(f"mark_{place.name}", f"mark_{place.category}.urdf", place.x, place.y, place.yaw))
    names = [model.name for model in models]
    for name in names:
        if names.count(name) > 1:
            raise BadInput(f"ward {ward.name!r}", f"{names.count(name)} things are named {name!r}", "unique names")
    return tuple(models)


def ward_directives(ward: Ward) -> str:
    """The model directives (`*.dmd.yaml`) of the ward."""
    blocks = ["# Generated from the ward map by scripts/make_ward_models.py.\ndirectives:\n"]
    for model in ward_models(ward):
        blocks.append(
            f"- add_model:\n    name: {model.name}\n    file: {_uri(model.file)}\n"
            f"- add_weld:\n    parent: world\n    child: {model.name}::base\n"
        )
        if model.x or model.y or model.yaw:
            x, y, yaw = (text_of(value) for value in (model.x, model.y, degrees(model.yaw)))
            blocks.append(f"    X_PC: {{translation: [{x}, {y}, 0], rotation: !Rpy {{deg: [0, 0, {yaw}]}}}}\n")
    return "".join(blocks)


def _tiles_text(region: BaseGeometry, dark: bool) -> str:
    return obj_text(floor_tiles(region)[dark])


def _floor_files(ward: Ward) -> dict[str, Callable[[], str]]:
    stem = _floor_stem(ward)
    extent = ward.half_extent + ward.wall_half_thickness
    regions = floor_regions(extent, ward.zones)
    files: dict[str, Callable[[], str]] = {}
    names = []
    for i, (_, region) in enumerate(regions):
        light, dark = f"{stem}_{i}_light.obj", f"{stem}_{i}_dark.obj"
        files[light], files[dark] = partial(_tiles_text, region, False), partial(_tiles_text, region, True)
        names.append((_uri(light), _uri(dark)))
    parts = partial(floor_parts, extent, [level for level, _ in regions], names)
    files[stem + ".urdf"] = partial(_model_text, FLOOR, parts)
    return files


def _furniture_parts(piece: Furniture) -> Sequence[Part]:
    return BUILDERS[piece.model](Size(piece.half_length, piece.half_width, piece.radius, piece.height))


def _letters_text(place: Place) -> str:
    return obj_text(sign_letters(place.name))


def _letters_file(place: Place) -> str:
    return f"letters_{place.name}.obj"


def _standing_signs(ward: Ward) -> dict[str, tuple[float, float]]:
    """Where the signs' poles stand, by place; a place without furniture has a mat instead."""
    places = [place for place in ward.places if place.name in ward.furniture_of]
    return {place.name: _sign_position(place, ward.furniture_of[place.name]) for place in places}


def _sign_files(ward: Ward) -> dict[str, tuple[str, Callable[[], str]]]:
    """The file of each place's sign and its text, by place."""
    heights = sign_heights(_standing_signs(ward))
    files: dict[str, tuple[str, Callable[[], str]]] = {}
    for place in ward.places:
        letters = _uri(_letters_file(place))
        if place.name in heights:
            height = heights[place.name]
            file = f"sign_{place.category}_{place.name}_{text_of(1000 * height)}.urdf"
            build = partial(standing_sign, place.name, place.category, letters, height)
        else:
            file = f"mat_{place.category}_{place.name}.urdf"
            build = partial(floor_sign, place.name, place.category, letters)
        files[place.name] = file, partial(_model_text, f"sign_{place.name}", build)
    return files


def _model_text(name: str, build: Callable[[], Sequence[Part]]) -> str:
    return urdf(name, build())


def ward_files(ward: Ward) -> Mapping[str, Callable[[], str]]:
    """The files that the directives refer to, by name in `PACKAGE_FOLDER`, each with the function that makes its text.

    The text is made on demand: for a ward whose files are there already nothing is made.
    """
    files = _floor_files(ward)
    files["mark.obj"] = lambda: obj_text(standing_mark())
    for piece in (*ward.walls, *ward.furniture):
        files[_furniture_file(piece)] = partial(_model_text, piece.model, partial(_furniture_parts, piece))
    for place in ward.places:
        mark = partial(place_mark, place.category, _uri("mark.obj"))
        files[f"mark_{place.category}.urdf"] = partial(_model_text, f"mark_{place.category}", mark)
        files[_letters_file(place)] = partial(_letters_text, place)
    files |= dict(_sign_files(ward).values())
    return files
