"""The one clock: each layer acts in the same tick as the one it listens to, and after it."""

from __future__ import annotations

import itertools

import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder, DiscreteValues, LeafSystem, State

from mala_drake import clock as mut

CHAIN = (mut.SENSE_OFFSET, mut.PLAN_OFFSET, mut.EXECUTE_OFFSET, mut.CONTROL_OFFSET, mut.METER_OFFSET, mut.LEARN_OFFSET)


class _Layer(LeafSystem):
    """Passes on, once a tick, one more than what it hears."""

    def __init__(self, offset: float) -> None:
        super().__init__()
        self._heard = self.DeclareVectorInputPort("heard", 1)
        self.DeclareStateOutputPort("said", self.DeclareDiscreteState(1))
        self.DeclarePeriodicDiscreteUpdateEvent(mut.TICK, offset, self._update)

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        discrete_state.set_value(self._heard.Eval(context) + 1.0)


def heard_through(offsets, *, until):
    """What comes out of a chain of layers with those offsets, after some seconds."""
    builder = DiagramBuilder()
    layers = [builder.AddSystem(_Layer(offset)) for offset in offsets]
    for earlier, later in itertools.pairwise(layers):
        builder.Connect(earlier.get_output_port(), later.get_input_port())
    builder.ExportInput(layers[0].get_input_port())
    builder.ExportOutput(layers[-1].get_output_port())
    diagram = builder.Build()
    simulator = Simulator(diagram)
    diagram.get_input_port().FixValue(simulator.get_mutable_context(), [0.0])
    simulator.AdvanceTo(until)
    return diagram.get_output_port().Eval(simulator.get_context())[0]


def test_one_tick_carries_a_message_through_every_layer():
    assert heard_through(CHAIN, until=0.5 * mut.TICK) == len(CHAIN)


def test_layers_that_act_at_one_instant_hear_each_other_a_tick_late():
    assert heard_through((0.0, 0.0), until=0.5 * mut.TICK) == 1.0


class _Unrestricted(LeafSystem):
    """Says in each unrestricted update that it has been."""

    def __init__(self, offset: float) -> None:
        super().__init__()
        self.DeclareStateOutputPort("said", self.DeclareDiscreteState(1))
        self.DeclarePeriodicUnrestrictedUpdateEvent(mut.TICK, offset, self._update)

    def _update(self, _context: Context, state: State) -> None:
        state.get_mutable_discrete_state().get_mutable_vector().SetAtIndex(0, 1.0)


def test_a_learner_hears_the_patient_within_a_tick_although_they_share_a_moment():
    builder = DiagramBuilder()
    patient, learner = builder.AddSystem(_Unrestricted(mut.PATIENT_OFFSET)), builder.AddSystem(_Layer(mut.LEARN_OFFSET))
    builder.Connect(patient.get_output_port(), learner.get_input_port())
    builder.ExportOutput(learner.get_output_port())
    diagram = builder.Build()
    simulator = Simulator(diagram)
    simulator.AdvanceTo(0.5 * mut.TICK)
    assert diagram.get_output_port().Eval(simulator.get_context())[0] == 2.0


def test_every_layer_has_acted_before_the_plant_moves_on():
    assert max(CHAIN) < mut.PLANT_STEP


def test_a_tick_is_a_whole_number_of_plant_steps():
    ratio = mut.TICK / mut.PLANT_STEP
    assert ratio == pytest.approx(round(ratio), abs=1e-12)
    assert ratio >= 1.0


def test_rounding_is_above_that_of_a_week_of_ticks_and_below_any_offset():
    week = 7 * 86_400.0
    assert abs(sum([mut.TICK] * 100_000) - 100_000 * mut.TICK) < mut.ROUNDING * 10
    assert week * 2**-52 < mut.ROUNDING < min(b - a for a, b in itertools.pairwise(CHAIN))
