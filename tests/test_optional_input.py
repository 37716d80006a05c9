"""An input port that is open says nothing, one that is not says what it holds."""

from pydrake.common.value import Value
from pydrake.systems.framework import LeafSystem

from mala_drake import optional_input as mut
from mala_drake.messages import LearnedCosts


def test_an_open_port_says_nothing_and_a_fixed_one_what_it_holds():
    system = LeafSystem()
    port = system.DeclareAbstractInputPort("learned_costs", Value(LearnedCosts()))
    context = system.CreateDefaultContext()
    nothing = LearnedCosts(updates=-1)
    assert mut.told(port, context, nothing) is nothing

    port.FixValue(context, Value(LearnedCosts(updates=3)))
    assert mut.told(port, context, nothing) == LearnedCosts(updates=3)
