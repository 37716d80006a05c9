"""What the plant does not tell the models: errors of mass and wheel radius, written into a model's SDF text.

The paper's premise is that the robot's nominal model is a little wrong and the difference is to be learned. The files
in `models/` are nominal; this is the one place where the plant departs from them.
"""

from __future__ import annotations

from xml.etree import ElementTree

from mala_drake.errors import BadInput

# Without this the prefix of Drake's own elements is renamed, and Drake no longer knows them.
ElementTree.register_namespace("drake", "drake.mit.edu")

MASS_ERROR = 0.05
"""Relative error of the body's mass at scale 1: the real robot is heavier."""

WHEEL_RADIUS_ERRORS = {"left_wheel": 0.02, "right_wheel": -0.01}
"""Relative errors of the wheels' radii at scale 1: the robot pulls to one side."""

MAX_SCALE = 10.0
"""Up to here a wheel's radius is off by a fifth; beyond, the robot is another one."""


def with_hidden_truth(sdf: str, scale: float) -> str:
    """The care robot's SDF text with its parameters off by `scale` times the errors above.

    Args:
        sdf: the text of `care_robot.sdf`.
        scale: 0 leaves the text as it is, 1 is the full error; other values in between or beyond scale it.

    Raises:
        BadInput: the scale is not finite, or so far beyond that nothing would be left of a mass or a radius.
    """
    if not abs(scale) <= MAX_SCALE:
        raise BadInput("hidden_truth", repr(scale), f"a number between {-MAX_SCALE:g} and {MAX_SCALE:g}")
    if scale == 0.0:
        return sdf
    root = ElementTree.fromstring(sdf)
    links = {link.get("name"): link for link in root.iter("link")}
    for value in links["base"].findall("inertial/mass") + links["base"].findall("inertial/inertia/*"):
        _scale(value, 1.0 + scale * MASS_ERROR)
    for name, error in WHEEL_RADIUS_ERRORS.items():
        radii = links[name].findall("collision//radius") + links[name].findall("visual[@name='tyre']//radius")
        for value in radii:
            _scale(value, 1.0 + scale * error)
    return ElementTree.tostring(root, encoding="unicode")


def _scale(element: ElementTree.Element, factor: float) -> None:
    element.text = repr(float(element.text or "0") * factor)
