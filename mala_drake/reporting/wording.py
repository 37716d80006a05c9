"""Names as people write them."""

from __future__ import annotations


def words(name: str) -> str:
    """A name for people: `speed_oriented` is `speed oriented`."""
    return name.replace("_", " ").replace("-", " ")


def readable_variant(variant: str) -> str:
    """A plan variant for people: `north/A/med-supp/left` is `north, A, medicine first, left`."""
    orders = {"med-supp": "medicine first", "supp-med": "supplement first"}
    return ", ".join(orders.get(part, words(part)) for part in variant.split("/"))


def title_of(name: str) -> str:
    """A name as a title: `speed_oriented` is `Speed oriented`."""
    text = words(name)
    return text[:1].upper() + text[1:]
