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


def loop(name, form, measured, moved):
    setpoint = f"{measured.name}.sp"
    return PidBlock(name, measured.name, form, measured, moved, setpoint, direct=False)


@cache
def cascade(outer=PI, inner=PI, rate_limited=False):
    """A level moves the setpoint of a flow, which moves the pump."""
    blocks = [
        PidBlock("outer", "level", outer, LEVEL, FLOW, "level.sp", direct=False),
        PidBlock("inner", "flow", inner, FLOW, PUMP, "outer", inner=True),
        OutputBlock(PUMP, "inner", rate_limited),
    ]
    return structure_law("cascade", blocks, setpoints={"level": LEVEL}, measured=[LEVEL, FLOW])


@cache
def override(selection="low", form=PI, rate_limited=False):
    """The lowest or highest of what a level and a flow ask of the pump."""
    blocks = [
        loop("level_loop", form, LEVEL, PUMP),
        loop("flow_loop", form, FLOW, PUMP),
        SelectorBlock("selected", ("level_loop", "flow_loop"), selection),
        OutputBlock(PUMP, "selected", rate_limited),
    ]
    return structure_law(
        "override", blocks, setpoints={"level": LEVEL, "flow": FLOW}, measured=[LEVEL, FLOW]
    )


@cache
def split_range(first=(0.0, 50.0, 100.0, 0.0), second=(50.0, 100.0, 0.0, 100.0), form=PI):
    """A level moves a pump in one part of its range and a valve in the other."""
    legs = Leg("split.pump", PUMP, *first), Leg("split.valve", VALVE, *second)
    blocks = [
        loop("level_loop", form, LEVEL, RANGE),
        SplitRangeBlock("split", "level_loop", legs),
        OutputBlock(PUMP, "split, pump"),
        OutputBlock(VALVE, "split, valve"),
    ]
    return structure_law("split_range", blocks, setpoints={"level": LEVEL}, measured=[LEVEL])


@cache
def feedforward(form=PI, dynamic=True):
    """A level loop with feedforward from a feed."""
    terms = (FeedforwardTerm("feed_to_pump", PUMP, FEED, measured=True, dynamic=dynamic),)
    blocks = [
        loop("level_loop", form, LEVEL, PUMP),
        FeedforwardBlock("sum", "level_loop", PUMP, terms),
        OutputBlock(PUMP, "sum"),
    ]
    return structure_law("feedforward", blocks, setpoints={"level": LEVEL}, measured=[LEVEL, FEED])


@cache
def ratio(form=None):
    """The pump in proportion to a feed; a level trims the ratio, if a form is given."""
    source = "level_loop" if form else None
    blocks = [
        RatioBlock("proportion", "proportion", FEED, PUMP, source),
        OutputBlock(PUMP, "proportion"),
    ]
    if form is None:
        return structure_law("ratio", blocks, setpoints={}, measured=[FEED])
    blocks.insert(0, loop("level_loop", form, LEVEL, RATIO))
    return structure_law(
        "trimmed_ratio", blocks, setpoints={"level": LEVEL}, measured=[FEED, LEVEL]
    )


@cache
def decoupled(form=PI):
    """Two loops, each fed forward what the other one moved at last: inverted decoupling."""
    blocks = []
    for i, (measured, moved, other) in enumerate(((LEVEL, PUMP, VALVE), (FLOW, VALVE, PUMP))):
        owner = f"{other.name}_to_{moved.name}"
        term = FeedforwardTerm(owner, moved, other, measured=False, dynamic=False)
        blocks += [
            loop(f"loop_{i}", form, measured, moved),
            FeedforwardBlock(f"sum_{i}", f"loop_{i}", moved, (term,)),
            OutputBlock(moved, f"sum_{i}"),
        ]
    return structure_law(
        "decoupled", blocks, setpoints={"level": LEVEL, "flow": FLOW}, measured=[LEVEL, FLOW]
    )


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
