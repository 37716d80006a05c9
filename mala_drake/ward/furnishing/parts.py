"""Boxes, cylinders and the like that a model is made of, and the URDF text of the model.

URDF and not SDF because the directives place some fifty models: Drake's SDF parser takes 30 ms a file before it reads
the first element, its URDF parser nothing to speak of.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass

from mala_drake.ward.furnishing.palette import Color

Interval = tuple[float, float]
Vector3 = tuple[float, float, float]

FRICTION = 1.0  # Coulomb friction of furniture and floor, static and dynamic.


@dataclass(frozen=True, slots=True)
class Size:
    """How large the map wants a piece of furniture: half sizes along its own x and y, or a radius; metres."""

    half_length: float
    half_width: float
    radius: float
    height: float


@dataclass(frozen=True, slots=True)
class Part:
    """One primitive in the frame of its model: seen when it has a color, solid when `solid` is true.

    `geometry` is the URDF element's tag with its attributes, for example `("box", {"size": "1 2 3"})`.
    """

    name: str
    geometry: tuple[str, dict[str, str]]
    position: Vector3
    rotation: Vector3 = (0.0, 0.0, 0.0)  # Roll, pitch, yaw; radians.
    color: Color | None = None
    solid: bool = False


def text_of(*values: float) -> str:
    """Numbers as URDF and YAML write them: nine digits, no negative zero."""
    return " ".join(f"{value + 0.0:.9g}" for value in (round(v, 12) for v in values))


def _positive(name: str, extent: float) -> float:
    """`extent`, which has to be positive: a model's size may leave no room for one of its parts."""
    if extent <= 0:
        raise ValueError(f"no room for its {name.replace('_', ' ')}")
    return extent


def box(name: str, x: Interval, y: Interval, z: Interval, color: Color | None, *, solid: bool = False) -> Part:
    """A box given by its bounds."""
    size = text_of(*(_positive(name, high - low) for low, high in (x, y, z)))
    center = (sum(x) / 2, sum(y) / 2, sum(z) / 2)
    return Part(name, ("box", {"size": size}), center, color=color, solid=solid)


def cylinder(
    name: str, x: float, y: float, z: Interval, radius: float, color: Color | None, *, solid: bool = False
) -> Part:
    """An upright cylinder."""
    sizes = {"radius": text_of(_positive(name, radius)), "length": text_of(_positive(name, z[1] - z[0]))}
    return Part(name, ("cylinder", sizes), (x, y, sum(z) / 2), color=color, solid=solid)


def ellipsoid(name: str, center: Vector3, radii: Vector3, color: Color) -> Part:
    """An ellipsoid along the model's axes; only to be seen."""
    return Part(
        name,
        ("drake:ellipsoid", dict(zip("abc", (text_of(_positive(name, radius)) for radius in radii), strict=True))),
        center,
        color=color,
    )


def capsule(name: str, center: Vector3, rotation: Vector3, radius: float, length: float, color: Color) -> Part:
    """A capsule along its own z; `length` is that of its cylinder. Only to be seen."""
    sizes = {"radius": text_of(_positive(name, radius)), "length": text_of(_positive(name, length))}
    return Part(name, ("drake:capsule", sizes), center, rotation, color)


def mesh(name: str, uri: str, color: Color, *, position: Vector3 = (0, 0, 0), rotation: Vector3 = (0, 0, 0)) -> Part:
    """A mesh file without materials of its own; only to be seen."""
    return Part(name, ("mesh", {"filename": uri}), position, rotation, color)


def urdf(name: str, parts: Sequence[Part]) -> str:
    """The URDF text of a model with one link, `base`, whose frame is on the floor."""
    root = ElementTree.Element("robot", {"xmlns:drake": "http://drake.mit.edu", "name": name})
    root.append(ElementTree.Comment(" Generated from the ward map by scripts/make_ward_models.py. "))
    link = ElementTree.SubElement(root, "link", name="base")
    for part in parts:
        if part.color is not None:
            material = ElementTree.SubElement(_element(link, "visual", part), "material")
            rgba = part.color if len(part.color) == 4 else (*part.color, 1.0)
            ElementTree.SubElement(material, "color", rgba=text_of(*rgba))
        if part.solid:
            properties = ElementTree.SubElement(_element(link, "collision", part), "drake:proximity_properties")
            for tag in ("drake:mu_static", "drake:mu_dynamic"):
                ElementTree.SubElement(properties, tag, value=text_of(FRICTION))
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _element(link: ElementTree.Element, tag: str, part: Part) -> ElementTree.Element:
    element = ElementTree.SubElement(link, tag, name=part.name)
    if any(part.position) or any(part.rotation):
        ElementTree.SubElement(element, "origin", xyz=text_of(*part.position), rpy=text_of(*part.rotation))
    kind, attributes = part.geometry
    ElementTree.SubElement(ElementTree.SubElement(element, "geometry"), kind, attributes)
    return element
