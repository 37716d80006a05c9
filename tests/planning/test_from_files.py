import json
from pathlib import Path

import pytest

import mala_drake.planning.from_files as mut
from mala_drake.errors import BadInput
from mala_drake.planning import plan_to_json

DATA = Path(__file__).parent.parent / "data" / "pddl"


def solve(name, **options):
    return mut.solve_files(DATA / f"{name}-domain.pddl", DATA / f"{name}-problem.pddl", **options)


def test_the_json_has_the_promised_fields():
    answer = json.loads(json.dumps(plan_to_json(solve("zenotravel"))))
    assert list(answer) == ["status", "cost", "actions", "expanded", "search_ms", "parse_ms", "ground_ms"]
    assert answer["status"] == "optimal"
    assert answer["cost"] == 112
    assert isinstance(answer["cost"], int)
    assert answer["actions"] == ["(board p jet a)", "(fly-slow jet a b)", "(debark p jet b)"]
    assert answer["expanded"] >= 3
    assert answer["parse_ms"] > 0


def test_costs_that_are_not_whole_are_floats_and_missing_ones_null():
    assert plan_to_json(solve("care"))["cost"] == pytest.approx(0.77928)
    late = plan_to_json(solve("care", timeout=1e-6))
    assert (late["status"], late["cost"], late["actions"]) == ("timeout", None, [])


def test_weights_reach_the_metric():
    assert solve("care", weights=[1, 0, 0, 0, 0]).cost != solve("care", weights=[0, 1, 0, 0, 0]).cost


def test_search_can_be_chosen():
    assert solve("hanoi", search="ucs").cost == solve("hanoi", search="astar").cost == 2**4 - 1


@pytest.mark.parametrize("timeout", [0.0, -1.0, float("nan")])
def test_a_timeout_must_be_positive(timeout):
    with pytest.raises(BadInput, match="positive number of seconds"):
        solve("hanoi", timeout=timeout)
