import math
from dataclasses import replace

import pytest
from pydrake.common.value import Value
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

import mala_drake.grounding as mut
from mala_drake.errors import BadInput
from mala_drake.grounding.fuzzy_grounding import SIGHT
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    Memberships,
    Outcome,
    PlaceMismatch,
    SymbolicState,
    WorldFacts,
)

LOCATIONS = {"pharmacy_north": (5.0, 18.0), "home": (0.0, 0.0), "pantry": (-3.0, 15.0)}
HAS_MEDICATION = ("has-medication", "robot1")
BATTERY_LOW = ("battery-low", "robot1")


def at(place, robot="robot1"):
    return ("at", robot, place)


class Probe:
    """A grounding with all its inputs fixed, to be changed one at a time."""

    def __init__(self, **options):
        self.system = mut.FuzzyGrounding(locations=LOCATIONS, **options)
        self.context = self.system.CreateDefaultContext()
        self.fix(robot_state=[0.0] * 6, charge=[1.0], world_facts=Value(WorldFacts()), action=Value(Action()))

    def fix(self, **inputs):
        for name, value in inputs.items():
            self.system.GetInputPort(name).FixValue(self.context, value)
        return self

    @property
    def memberships(self) -> Memberships:
        return self.system.GetOutputPort("memberships").Eval(self.context)

    @property
    def place_mismatch(self) -> PlaceMismatch:
        return self.system.GetOutputPort("place_mismatch").Eval(self.context)

    @property
    def reach_mismatch(self) -> PlaceMismatch:
        return self.system.GetOutputPort("reach_mismatch").Eval(self.context)

    @property
    def symbolic_state(self) -> SymbolicState:
        return self.system.GetOutputPort("symbolic_state").Eval(self.context)


@pytest.fixture
def dut():
    return Probe()


def test_drawn_ports_are_the_real_ports(dut, assert_port_box):
    assert_port_box(dut.system)


def test_at_a_place_its_atom_holds(dut):
    dut.fix(robot_state=[5.0, 16.5, 1.0, 0.3, 0.0, 0.1])
    assert dut.symbolic_state == SymbolicState((at("pharmacy_north"),), "pharmacy_north", 1.0)
    assert dut.memberships.value(at("pharmacy_north")) == pytest.approx((5.0 - 1.5) / 4.0)
    assert dut.memberships.value(at("pantry")) == 0.0


def test_without_degrees_the_same_place_holds_and_of_two_the_expected_one():
    crisp = Probe(location_membership=mut.AlphaCut(mut.SaturatedRamp()))
    crisp.fix(robot_state=[5.0, 16.5, 1.0, 0.3, 0.0, 0.1])
    assert crisp.symbolic_state == SymbolicState((at("pharmacy_north"),), "pharmacy_north", 1.0)
    assert crisp.memberships.values[:3] == (0.0, 0.0, 1.0)
    crisp.fix(robot_state=[5.0, 15.7, 1.0, 0.3, 0.0, 0.1])
    assert crisp.symbolic_state.place == ""


def test_in_transit_no_place_holds_although_memberships_are_positive(dut):
    dut.fix(robot_state=[0.0, 3.0, 0.0, 1.5, 0.0, 0.0])
    assert dut.symbolic_state == SymbolicState((), "", 1.0)
    assert dut.memberships.value(at("home")) == pytest.approx(0.5)


def test_memberships_of_places_come_first_and_in_one_order(dut):
    dut.fix(world_facts=Value(WorldFacts((HAS_MEDICATION,))))
    assert dut.memberships.atoms == (
        at("home"),
        at("pantry"),
        at("pharmacy_north"),
        HAS_MEDICATION,
        BATTERY_LOW,
    )


def test_established_facts_hold_beside_the_place_in_sorted_order(dut):
    dut.fix(world_facts=Value(WorldFacts((HAS_MEDICATION, ("correct-medication", "robot1")))))
    assert dut.symbolic_state.atoms == (at("home"), ("correct-medication", "robot1"), HAS_MEDICATION)


def test_the_robots_place_is_never_taken_from_the_facts(dut):
    claims = WorldFacts((at("moon"), at("pantry"), at("pantry", "robot2")))
    dut.fix(robot_state=[0.0, 5.0, 0, 0, 0, 0], world_facts=Value(claims))
    assert dut.symbolic_state == SymbolicState((at("pantry", "robot2"),), "", 1.0)
    assert dut.memberships.value(at("pantry")) == 0.0
    assert at("moon") not in dut.memberships.atoms


@pytest.mark.parametrize(("charge", "low"), [(0.5, False), (0.19, False), (0.17, True), (0.0, True)])
def test_a_low_battery_is_an_atom_like_any_other(dut, charge, low):
    dut.fix(charge=[charge])
    assert (BATTERY_LOW in dut.symbolic_state.atoms) is low
    assert dut.symbolic_state.charge == charge


@pytest.mark.parametrize("index", range(6))
@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_a_state_that_is_not_finite_leaves_the_place_unknown(dut, index, number):
    robot_state = [0.0] * 6
    robot_state[index] = number
    dut.fix(robot_state=robot_state, world_facts=Value(WorldFacts((HAS_MEDICATION,))))
    assert dut.symbolic_state == SymbolicState((HAS_MEDICATION,), "", 1.0)
    assert dut.memberships.value(at("home")) == 0.0


@pytest.mark.parametrize(("charge", "taken"), [(math.nan, 0.0), (math.inf, 0.0), (-0.1, 0.0), (1.01, 1.0)])
def test_a_charge_without_meaning_is_taken_on_the_safe_side(dut, charge, taken):
    dut.fix(charge=[charge])
    assert dut.symbolic_state.charge == taken
    assert (BATTERY_LOW in dut.symbolic_state.atoms) is (taken == 0.0)


def test_where_two_places_are_fully_true_the_expected_one_is_meant():
    system = mut.FuzzyGrounding(locations={"left": (0.0, 0.5), "right": (0.0, -0.5)})
    context = system.CreateDefaultContext()
    system.GetInputPort("robot_state").FixValue(context, [0.0] * 6)
    system.GetInputPort("charge").FixValue(context, [1.0])
    system.GetInputPort("world_facts").FixValue(context, Value(WorldFacts()))
    action = system.GetInputPort("action").FixValue(context, Value(Action()))
    state = system.GetOutputPort("symbolic_state")
    assert state.Eval(context).place == "left"
    action.GetMutableData().set_value(Action(1, ActionKind.MOVE, "approach_right", place="right"))
    assert state.Eval(context).place == "right"


def test_a_predicate_can_be_given_its_own_membership():
    near = ("near", "robot1", "patient1")
    region = mut.ProximityMembership(((near, mut.LocationMembership((0.0, 0.0), mut.Gaussian(0.0, 1.0))),))
    dut = Probe(predicate_memberships={"near": region})
    # A fact of a predicate with a membership function of its own is for that function to judge.
    dut.fix(robot_state=[1.0, 0, 0, 0, 0, 0], world_facts=Value(WorldFacts((near, HAS_MEDICATION))))
    assert dut.memberships.value(near) == pytest.approx(math.exp(-0.5))
    assert dut.symbolic_state.atoms == (at("home"), HAS_MEDICATION)
    assert dut.fix(robot_state=[0.5, 0, 0, 0, 0, 0]).symbolic_state.atoms == (at("home"), HAS_MEDICATION, near)


def test_threshold_membership_and_name_are_options():
    dut = Probe(robot="nurse", threshold=0.4, location_membership=mut.TruncatedAnnulus(1.0, 16.0, 3.0))
    dut.fix(robot_state=[0.0, 3.0, 0, 0, 0, 0])
    assert dut.memberships.value(at("home", "nurse")) == pytest.approx(math.exp(-8.0 / 9.0))
    assert dut.symbolic_state.place == "home"


def test_bad_options_are_refused():
    with pytest.raises(BadInput):
        mut.FuzzyGrounding(locations=LOCATIONS, threshold=1.5)


def test_it_depends_on_its_inputs_only_and_on_all_of_them(dut):
    assert dut.system.HasDirectFeedthrough(1)
    assert dut.context.is_stateless()


def test_a_diagram_evaluates_it_from_wired_ports():
    builder = DiagramBuilder()
    grounding = builder.AddSystem(mut.FuzzyGrounding(locations=LOCATIONS))
    state = builder.AddSystem(ConstantVectorSource([-3.0, 15.0, 0, 0, 0, 0]))
    charge = builder.AddSystem(ConstantVectorSource([0.8]))
    builder.Connect(state.get_output_port(), grounding.GetInputPort("robot_state"))
    builder.Connect(charge.get_output_port(), grounding.GetInputPort("charge"))
    for name in ("world_facts", "action"):
        builder.ExportInput(grounding.GetInputPort(name), name)
    builder.ExportOutput(grounding.GetOutputPort("symbolic_state"), "symbolic_state")
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    diagram.GetInputPort("world_facts").FixValue(context, Value(WorldFacts()))
    diagram.GetInputPort("action").FixValue(context, Value(Action()))
    assert diagram.GetOutputPort("symbolic_state").Eval(context).place == "pantry"


TO_PANTRY = Action(1, ActionKind.MOVE, "go_to_pantry", ("robot1",), "pantry")


def test_what_is_missing_at_the_expected_place_is_told_with_its_derivative(dut):
    x, y = LOCATIONS["pantry"]
    dut.fix(action=Value(TO_PANTRY), robot_state=[x + 1.5, y - 2.0, 0.3, 0.0, 0.0, 0.0])
    mismatch = dut.place_mismatch
    assert (mismatch.place, mismatch.offset) == ("pantry", (-1.5, 2.0))
    assert mismatch.error == pytest.approx((2.5 - 1.0) / 4.0)
    for i, gradient in enumerate(mismatch.gradient):
        errors = []
        for sign in (1.0, -1.0):
            state = [x + 1.5, y - 2.0, 0.3, 0.0, 0.0, 0.0]
            state[i] += sign * 1e-6
            errors.append(dut.fix(robot_state=state).place_mismatch.error)
        assert gradient == pytest.approx((errors[0] - errors[1]) / 2e-6, abs=1e-8)


def test_on_the_plateau_nothing_is_missing(dut):
    x, y = LOCATIONS["pantry"]
    dut.fix(action=Value(TO_PANTRY), robot_state=[x, y + 0.9, 0.0, 0.0, 0.0, 0.0])
    assert dut.place_mismatch == PlaceMismatch("pantry", 0.0, (0.0, 0.0), (0.0, pytest.approx(-0.9)))


def test_a_place_out_of_sight_is_not_seen(dut):
    x, y = LOCATIONS["pantry"]
    dut.fix(action=Value(TO_PANTRY), robot_state=[x + SIGHT + 0.1, y, 0.0, 0.0, 0.0, 0.0])
    assert dut.place_mismatch == PlaceMismatch("pantry", 1.0, (0.0, 0.0), None)


def test_without_an_expected_place_or_a_position_there_is_no_mismatch(dut):
    assert dut.place_mismatch == PlaceMismatch()
    dut.fix(action=Value(TO_PANTRY), robot_state=[math.nan] + [0.0] * 5)
    assert dut.place_mismatch == PlaceMismatch()


def test_what_is_out_of_reach_is_missing_to_a_degree(dut):
    assert dut.reach_mismatch == PlaceMismatch()  # Nobody is connected.
    collect = Action(4, ActionKind.IN_PLACE, "collect_ingredient", ("robot1",), "pantry", "pantry")
    out_of_reach = ActionReport(4, Outcome.OUT_OF_REACH, shortfall=(0.0, -0.8))
    dut.fix(action=Value(collect), in_place_report=Value(out_of_reach))
    assert dut.reach_mismatch == PlaceMismatch("pantry", pytest.approx(0.2), (0.0, 0.25))
    dut.fix(in_place_report=Value(ActionReport(4, Outcome.NOT_THERE)))
    assert dut.reach_mismatch == PlaceMismatch()
    dut.fix(action=Value(replace(collect, sequence=5)), in_place_report=Value(out_of_reach))
    assert dut.reach_mismatch == PlaceMismatch()  # It is about an earlier action.
