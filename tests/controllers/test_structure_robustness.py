"""Every scheme under anything that can arrive: outputs within limits, states numbers."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pid_rig import Scans
from scheme_rig import SCHEMES

from clepsydra.controllers.signals import owners

anything = st.floats()
plausible = st.floats(0.0, 10.0)


def value_of(signal):
    """What arrives at an input: mostly plausible, at times anything."""
    part = signal.part
    if part == "mode":
        return st.sampled_from([0.0, 1.0, 1.0, 1.0, 2.0, 3.0])
    if part == "good":
        return st.sampled_from([0.0, 1.0, 1.0, 1.0])
    if part == "setpoint_source":
        return st.sampled_from([0.0, 1.0, 2.0])
    if part == "time_step":
        return st.one_of(st.sampled_from([0.5, 1.0]), anything)
    return st.one_of(plausible, plausible, anything)


def check(scheme, outputs):
    for output in owners(scheme.law.outputs, "out"):
        low, high = (scheme.values[f"{output}.{end}_limit"] for end in ("low", "high"))
        assert low <= outputs[f"{output}.out"] <= high
        assert outputs[f"{output}.status"] in range(256)
    assert all(abs(value) <= 1e300 for value in scheme.state.values()), scheme.state


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCHEMES)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_outputs_within_limits_and_states_numbers_whatever_comes(name, data):
    law = SCHEMES[name]
    scheme = Scans(law, {})
    for _ in range(data.draw(st.integers(1, 6))):
        given_inputs = {signal.name: data.draw(value_of(signal)) for signal in law.inputs}
        changed = data.draw(
            st.sampled_from([p.name for p in law.parameters if "limit" not in p.name])
        )
        scheme.set(**{changed: data.draw(anything)})
        check(scheme, scheme.scan(**given_inputs))


@pytest.mark.parametrize("name", SCHEMES)
def test_after_every_signal_failed_once_it_controls_again(name):
    """A fault of each input, one after the other, leaves nothing behind that stops control."""
    law = SCHEMES[name]
    parts = ("sp", "pv", "local_setpoint", "tracking", "manual")
    rest = {signal.name: 5.0 for signal in law.inputs if signal.part in parts}
    modes = {signal.name: 1.0 for signal in law.inputs if signal.part in ("mode", "good")}
    scheme = Scans(law, {}, **rest, **modes, time_step=0.5)
    untouched = scheme.twin()
    for signal in law.inputs:
        for wrong in (math.nan, math.inf, -math.inf, 1e301):
            before = scheme.inputs[signal.name]
            for _ in range(3):
                check(scheme, scheme.scan(**{signal.name: wrong}))
            check(scheme, scheme.scan(**{signal.name: before}))
    moved = [signal.name for signal in law.inputs if signal.part == "pv"]
    for instance in (scheme, untouched):
        instance.give(dict.fromkeys(moved, 4.5))
    found, expected = (instance.scan() for instance in (scheme, untouched))
    # All at rest: a fault moves nothing, and what the measurements then do acts as ever.
    for output in expected:
        assert found[output] == pytest.approx(expected[output], abs=1e-7)
