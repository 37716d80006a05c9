"""Texts of options as values; mistakes are told through the command line, in `test_cli`."""

from __future__ import annotations

import pytest

from mala_drake import cli_options as mut
from mala_drake.errors import BadInput


@pytest.mark.parametrize(
    ("text", "seeds"),
    [("0", (0,)), ("0,1,7", (0, 1, 7)), ("0-4", (0, 1, 2, 3, 4)), (" 3 , 5-6 ", (3, 5, 6)), ("2-2", (2,))],
)
def test_seeds_are_numbers_and_ranges(text, seeds):
    assert mut.seeds_of(text) == seeds


@pytest.mark.parametrize("text", ["", "1,", "4-0", "-1", "1.5", "0-10000", "1-2-3"])
def test_other_seeds_are_refused(text):
    with pytest.raises(BadInput, match="--seeds"):
        mut.seeds_of(text)


def test_names_are_separated_by_commas():
    assert mut.names_of("--profiles", " one,two ") == ("one", "two")
    with pytest.raises(BadInput, match="--profiles"):
        mut.names_of("--profiles", "one,,two")


def test_weights_are_five_numbers_on_the_simplex():
    assert mut.weights_of("0.5,0.2,0.1,0.1,0.1") == (0.5, 0.2, 0.1, 0.1, 0.1)
    for text in ("0.5,0.5", "1,1,1,1,1", "a,b,c,d,e"):
        with pytest.raises(BadInput, match="--weights"):
            mut.weights_of(text)


def test_what_is_left_out_stays_open():
    assert (mut.seeds_of(None), mut.names_of("--profiles", None), mut.weights_of(None)) == (None, None, None)


def test_options_go_before_the_file(tmp_path):
    file = tmp_path / "my.yaml"
    file.write_text("{episodes: 3, random_seed: 5, patient: {true_weights: [0.2, 0.2, 0.2, 0.2, 0.2]}}")
    as_told = mut.chosen_scenario(file, None, None, None, None, None)
    assert (as_told.episodes, as_told.random_seed, as_told.profile_name) == (3, 5, "custom")
    changed = mut.chosen_scenario(file, "meal", "safety_first", 4, 6, "snopt")
    assert (changed.task, changed.profile_name, changed.episodes) == ("meal", "safety_first", 4)
    assert (changed.random_seed, changed.control.solver) == (6, "snopt")


def test_a_mistake_is_told_by_the_option_that_has_set_the_field():
    with pytest.raises(BadInput, match="--episodes"):
        mut.chosen_scenario(None, None, None, 0, None, None)
