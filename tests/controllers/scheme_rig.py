"""Control schemes of blocks: one of each structure, with a level, a flow, a pump and valves."""

from functools import cache

from clepsydra import PidForm, Signal
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock

LEVEL = Signal("level", "m", low=0.0, high=10.0)
FLOW = Signal("flow", "l/s", low=0.0, high=20.0)
FEED = Signal("feed", "l/s", low=0.0, high=20.0)
PUMP = Signal("pump", "%", low=0.0, high=100.0)
VALVE = Signal("valve", "%", low=0.0, high=100.0)
RANGE = Signal("range", "%", low=0.0, high=100.0)
RATIO = Signal("trim", low=0.0, high=10.0)
PI = PidForm()


@cache
def cascade(outer=PI, inner=PI, rate_limited=False):
    """A level moves the setpoint of a flow, which moves the pump."""
    blocks = [
        PidBlock("outer", 1, outer, LEVEL, 1, FLOW, 1, None),
        PidBlock("inner", 2, inner, FLOW, 2, PUMP, "outer", 1),
        OutputBlock(1, PUMP, "inner", rate_limited),
    ]
    return structure_law("cascade", blocks, controlled=[LEVEL], measured=[LEVEL, FLOW])


@cache
def override(selection="low", form=PI, rate_limited=False):
    """The lowest or highest of what a level and a flow ask of the pump."""
    blocks = [
        PidBlock("level_loop", 1, form, LEVEL, 1, PUMP, 1, None),
        PidBlock("flow_loop", 2, form, FLOW, 2, PUMP, 2, None),
        SelectorBlock("selected", ("level_loop", "flow_loop"), selection),
        OutputBlock(1, PUMP, "selected", rate_limited),
    ]
    return structure_law("override", blocks, controlled=[LEVEL, FLOW], measured=[LEVEL, FLOW])


@cache
def split_range(first=(0.0, 50.0, 100.0, 0.0), second=(50.0, 100.0, 0.0, 100.0), form=PI):
    """A level moves a pump in one part of its range and a valve in the other."""
    blocks = [
        PidBlock("level_loop", 1, form, LEVEL, 1, RANGE, 1, None),
        SplitRangeBlock("split", "level_loop", (Leg(1, PUMP, *first), Leg(2, VALVE, *second))),
        OutputBlock(1, PUMP, "split, pump"),
        OutputBlock(2, VALVE, "split, valve"),
    ]
    return structure_law("split_range", blocks, controlled=[LEVEL], measured=[LEVEL])


@cache
def feedforward(form=PI, dynamic=True):
    """A level loop with feedforward from a feed."""
    terms = (FeedforwardTerm("1", FEED, "measurement_2", dynamic),)
    blocks = [
        PidBlock("level_loop", 1, form, LEVEL, 1, PUMP, 1, None),
        FeedforwardBlock("sum", "level_loop", PUMP, terms),
        OutputBlock(1, PUMP, "sum"),
    ]
    return structure_law("feedforward", blocks, controlled=[LEVEL], measured=[LEVEL, FEED])


@cache
def ratio(form=None):
    """The pump in proportion to a feed; a level trims the ratio, if a form is given."""
    source = "level_loop" if form else None
    blocks = [
        RatioBlock("proportion", 1, FEED, 1, PUMP, source),
        OutputBlock(1, PUMP, "proportion"),
    ]
    if form is None:
        return structure_law("ratio", blocks, controlled=[], measured=[FEED])
    blocks.insert(0, PidBlock("level_loop", 1, form, LEVEL, 2, RATIO, 1, None))
    return structure_law("trimmed_ratio", blocks, controlled=[LEVEL], measured=[FEED, LEVEL])


@cache
def decoupled(form=PI):
    """Two loops, each fed forward what the other one moved at last: inverted decoupling."""
    blocks = []
    for i, (measured, moved) in enumerate(((LEVEL, PUMP), (FLOW, VALVE)), start=1):
        other = 3 - i
        term = FeedforwardTerm(
            f"{i}_{other}", (PUMP, VALVE)[other - 1], f"last_output_{other}", False
        )
        blocks += [
            PidBlock(f"loop_{i}", i, form, measured, i, moved, i, None),
            FeedforwardBlock(f"sum_{i}", f"loop_{i}", moved, (term,)),
            OutputBlock(i, moved, f"sum_{i}"),
        ]
    return structure_law("decoupled", blocks, controlled=[LEVEL, FLOW], measured=[LEVEL, FLOW])


SCHEMES = {
    "cascade": cascade(),
    "cascade-velocity": cascade(inner=PidForm("PID", "velocity"), rate_limited=True),
    "cascade-conditional": cascade(PidForm(anti_windup="conditional_integration")),
    "override-low": override("low"),
    "override-high": override("high", PidForm("PID", "series"), True),
    "split-range": split_range(),
    "split-range-with-a-gap": split_range((0.0, 40.0, 100.0, 0.0), (60.0, 100.0, 0.0, 100.0)),
    "feedforward": feedforward(),
    "feedforward-velocity": feedforward(PidForm("PI", "velocity"), False),
    "ratio": ratio(),
    "trimmed-ratio": ratio(PI),
    "decoupled": decoupled(),
}
