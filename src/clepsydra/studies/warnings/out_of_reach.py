"""What a scenario asks of final elements that they cannot give, whatever the controller."""

from __future__ import annotations

from clepsydra.base.remark import Remark
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.equilibrium import inputs_beyond_at
from clepsydra.linear.equilibrium_inputs import BeyondRange
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import beyond_of_range, shown
from clepsydra.loop.scenario import Scenario, Segment
from clepsydra.studies.warnings.resting import passes


def out_of_reach(model: LinearModel, scenario: Scenario) -> tuple[Remark, ...]:
    """Return which final elements cannot give what setpoint and load steps ask for in the end.

    The balances of the process itself are solved with the setpoints and loads of each step, so
    that the flow that an element gives at the end of its range stands beside the one that is
    needed. Of several steps the one that asks most of an element is told. A process with other
    than one input for each controlled variable can share the load in many ways, and is left out.

    Parameters
    ----------
    model : LinearModel
        Of the process at the operating point where the scenario begins.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> model = cl.load("quadruple-tank").linear
    >>> out_of_reach(model, default_scenario(model))
    ()
    """
    point = operating_point_of(model)
    process = point.process
    if len(process.controlled) != len(process.inputs):
        return ()
    resting = at_rest(model)
    most: dict[tuple[str, float], tuple[Segment, BeyondRange]] = {}
    for segment in scenario.segments:
        over = segment.kind == "load" and passes(resting, point, scenario, segment)
        if segment.kind == "noise" or over:
            continue
        sample = scenario.settled_sample_of(segment)
        outputs = dict(zip(process.controlled, scenario.setpoints[sample], strict=True))
        for beyond in inputs_beyond_at(point, outputs, scenario.disturbances[sample]):
            key = beyond.signal.name, beyond.end
            if key not in most or beyond.excess > most[key][1].excess:
                most[key] = segment, beyond
    return tuple(_words(point, *asked) for asked in most.values())


def _words(point: OperatingPoint, segment: Segment, beyond: BeyondRange) -> Remark:
    signal, flows = beyond.signal, beyond.flows
    stepped = point.process.signal(segment.signal)
    step = f"to hold the {segment.kind} step of {stepped.name} by {shown(stepped, segment.size)}"
    if beyond.flow is None or flows is None:
        seen = f"{signal.name} would have to be {beyond_of_range(signal, beyond.value)}, {step}"
    else:
        given, needed = beyond.flow.shown_apart(*flows)
        which = "most" if flows[1] > flows[0] else "least"
        asked = f"{needed} are needed"
        if flows[1] < 0.0:
            asked = f"{beyond.flow.shown(-flows[1])} would have to flow back through it"
        seen = f"{signal.name} gives at {which} {given}, and {asked} {step}"
    return Remark(
        seen, "no controller can change that", "give it another size, or make the step smaller"
    )
