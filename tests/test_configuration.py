"""Reading YAML: good files fill a dataclass, and every mistake is one line with file, field, value and expectation."""

from dataclasses import dataclass, field

import pytest

from mala_drake import configuration as mut
from mala_drake.errors import BadInput


@dataclass
class Wheel:
    radius: float = 0.1
    driven: bool = True


@dataclass
class Vehicle:
    name: str = "cart"
    wheels: int = 4
    mass: float = 10.0
    front: Wheel = field(default_factory=Wheel)
    tags: list[str] = field(default_factory=list)
    others: list[Wheel] = field(default_factory=list)


def load(tmp_path, text):
    path = tmp_path / "vehicle.yaml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return mut.load_typed(Vehicle, path, defaults=Vehicle())


def test_missing_fields_keep_their_defaults(tmp_path):
    assert load(tmp_path, "mass: 3\nfront: {radius: 0.2}\n") == Vehicle(mass=3.0, front=Wheel(radius=0.2))


def test_an_empty_file_is_all_defaults(tmp_path):
    assert load(tmp_path, "# nothing\n") == Vehicle()


def test_lists_are_read(tmp_path):
    read = load(tmp_path, "tags: [a, b]\nothers: [{radius: 1.0, driven: false}]\n")
    assert read.tags == ["a", "b"]
    assert read.others == [Wheel(1.0, False)]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("masss: 3\n", ["vehicle.yaml", "masss", "unknown key", "mass"]),
        ("front: {radios: 3}\n", ["vehicle.yaml", "front", "radios", "radius"]),
        ("mass: heavy\n", ["vehicle.yaml", "mass", "heavy", "number"]),
        ("wheels: 3.5\n", ["vehicle.yaml", "wheels", "3.5", "whole number"]),
        ("wheels: true\n", ["wheels", "True", "whole number"]),
        ("front: 7\n", ["front", "7", "mapping"]),
        ("name: [1]\n", ["name", "text"]),
        ("tags: one\n", ["tags", "one", "list"]),
        ("others: [{radios: 1.0}]\n", ["others[0]", "radios", "radius"]),
        ("front: {driven: 1}\n", ["driven", "1", "true or false"]),
        ("- a\n- b\n", ["vehicle.yaml", "list", "mapping"]),
        ("mass: [3\n", ["vehicle.yaml", "not YAML"]),
        ("name: x\nmass: 2024-13-45\n", ["vehicle.yaml:2:7", "'2024-13-45' is no timestamp that can be read"]),
        (f"wheels: {'9' * 5000}\n", ["vehicle.yaml:1:9", "'99999", "is no int that can be read"]),
        (f"mass: 1{'0' * 400}\n", ["vehicle.yaml:1:7", "'10000", "is no int that can be read"]),
        (f"name: 0x{'f' * 5000}\n", ["vehicle.yaml:1:7", "'0xfff", "is no int that can be read"]),
        ("tags: [a, 0x_]\n", ["vehicle.yaml:1:11", "'0x_' is no int"]),
        (b"\xff\xfe\x00", ["vehicle.yaml", "cannot be read"]),
    ],
)
def test_a_mistake_is_told_in_one_line(tmp_path, text, words):
    with pytest.raises(BadInput) as caught:
        load(tmp_path, text)
    line = str(caught.value)
    assert "\n" not in line
    assert len(line) < 300
    for word in words:
        assert word in line


def test_a_number_that_no_float_can_hold_is_refused_in_a_mapping_too():
    with pytest.raises(BadInput, match="here: int too large"):
        mut.typed(Vehicle, {"mass": 10**400}, where="here", defaults=Vehicle())


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(BadInput, match=r"nowhere\.yaml.*cannot be read"):
        mut.load_typed(Vehicle, tmp_path / "nowhere.yaml", defaults=Vehicle())
