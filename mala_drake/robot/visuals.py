"""What models look like, left out where nobody looks."""

from __future__ import annotations

from xml.etree import ElementTree

# Without this the prefix of Drake's own elements is renamed, and Drake no longer knows them.
ElementTree.register_namespace("drake", "drake.mit.edu")


def without_visuals(sdf: str) -> str:
    """The SDF text of a model without its visual geometries.

    They have no part in the physics, but are moved at every step of the plant like all others.
    """
    root = ElementTree.fromstring(sdf)
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    return ElementTree.tostring(root, encoding="unicode")
