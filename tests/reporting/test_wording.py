"""Names as people write them."""

from __future__ import annotations

from mala_drake.reporting import wording as mut


def test_names_are_words():
    assert mut.words("presentation_focused") == "presentation focused"
    assert mut.title_of("speed_oriented") == "Speed oriented"


def test_variants_are_lists():
    assert mut.readable_variant("south/B/supp-med/right") == "south, B, supplement first, right"
    assert mut.readable_variant("hot_meal/left") == "hot meal, left"
