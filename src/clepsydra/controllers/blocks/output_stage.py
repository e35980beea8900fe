"""The output stage of a law with one integral for each output: anti-windup, mode, limits, hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.final_element import (
    LAST_OUTPUT,
    OUTPUT_PORTS,
    asked_ports,
    output_element,
    output_results,
    told,
)
from clepsydra.controllers.blocks.handover import Applied, Asked
from clepsydra.controllers.blocks.integral import applied_ports, integral
from clepsydra.controllers.blocks.ports import as_parts, called, parts_of, truth
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class OutputStage:
    """One output of a law after its output stage.

    Parameters
    ----------
    moved : Signal
        The process input.
    manipulated : casadi.SX
        The output, always a number within its limits.
    next_state : mapping
        Its integral and last_output.
    status : casadi.SX
        The status word.
    intermediates : dict
        Names for values on the way, which a printed program uses.

    Examples
    --------
    >>> stage = OutputStage(Signal("pump"), ca.SX(10), {"pump.integral": ca.SX(7)}, ca.SX(9), {})
    >>> float(ca.evalf(stage.manipulated)), stage.moved.name
    (10.0, 'pump')
    """

    moved: Signal
    manipulated: ca.SX
    next_state: dict[str, ca.SX]
    status: ca.SX
    intermediates: dict[str, ca.SX]


def output_stage(
    symbols: Symbols,
    moved: Signal,
    *,
    proportional: ca.SX,
    increment: ca.SX,
    signals_are_numbers: ca.SX,
    sensors_are_good: ca.SX,
    anti_windup: AntiWindup,
    taken_up: ca.SX | None = None,
) -> OutputStage:
    """Write the output stage of one output: an instance of `output_stage_block`.

    Parameters
    ----------
    symbols : mapping
        The law's signals by name: integral, last_output, mode, manual, tracking, low_limit,
        high_limit and tracking_time (back-calculation) of the process input, and time_step.
    moved : Signal
        The process input.
    proportional : casadi.SX
        The part of the output that does not come from the integral, in its unit.
    increment : casadi.SX
        What the integral gains in this sample in automatic, in the unit of the output.
    signals_are_numbers, sensors_are_good : casadi.SX
        Whether the setpoints and measurements used are numbers, and their sensors sound.
    anti_windup : AntiWindup
    taken_up : casadi.SX, optional
        What the integral takes up of a change of gains, where the signals are valid.

    Examples
    --------
    An output that asks for 12 stands at its high limit of 10: automatic (1) + high limit (8).

    >>> given = dict(integral=7, last_output=0, mode=1, manual=0, tracking=0, low_limit=0,
    ...              high_limit=10)
    >>> symbols = {f"pump.{name}": ca.DM(value) for name, value in given.items()}
    >>> true = ca.DM(1)
    >>> stage = output_stage(symbols | {"time_step": true}, Signal("pump"),
    ...                      proportional=ca.DM(5), increment=ca.DM(1), signals_are_numbers=true,
    ...                      sensors_are_good=true, anti_windup="conditional_integration")
    >>> float(stage.manipulated), stage.next_state["pump.integral"], float(ca.evalf(stage.status))
    (10.0, DM(7), 9.0)
    """
    block = output_stage_block(anti_windup, takes_up=taken_up is not None)
    given = {
        **parts_of(moved, symbols, [*block.state, *block.inputs]),
        "proportional": proportional,
        "increment": increment,
        "numbers": signals_are_numbers,
        "sensors": sensors_are_good,
    }
    if taken_up is not None:
        given["taken_up"] = taken_up
    found = called(block, path(moved, "stage"), given)
    status, conditions = told(found.outputs, moved)
    return OutputStage(
        moved,
        found.outputs["manipulated"],
        as_parts(moved, found.next_state),
        status,
        {**as_parts(moved, found.intermediates), **conditions},
    )


@cache
def output_stage_block(anti_windup: AntiWindup, *, takes_up: bool = False) -> Block:
    """Return the block of an output with an integral: proportional + integral in automatic.

    The integral takes its increment under the anti-windup rule (`blocks.integral`). The other
    modes, limits and faults are those of every output (`blocks.final_element`).

    Parameters
    ----------
    anti_windup : AntiWindup
    takes_up : bool
        Whether it has the port taken_up.

    Examples
    --------
    >>> [entry.name for entry in output_stage_block("none").state]
    ['integral', 'last_output']
    """
    element, action = output_element(), integral(anti_windup)

    def equations(s: Symbols) -> Equations:
        known = ca.logic_and(s["numbers"], s["sensors"])
        before = s["integral"]
        if takes_up:
            before = before + ca.if_else(known, s["taken_up"], 0)
        unlimited = s["proportional"] + before
        asked = asked_ports(Asked(unlimited, known, s["numbers"], s["sensors"]))
        given = {**s, **asked, "integral": before, "known": known, "last_applied": s["last_output"]}
        found = element("output_end", {p.name: given[p.name] for p in element.inputs}, {}).outputs
        manipulated = found["manipulated"]
        given |= applied_ports(Applied(manipulated, found["controls"], found["follows"]))
        ended = called(action, "integral_action", given)
        return Equations(
            {"integral": ended.outputs["following"], "last_output": manipulated},
            {signal.name: found[signal.name] for signal in output_results()},
            {"signals_known": known, "unlimited": unlimited},
        )

    own = [p for p in action.inputs if p.name in ("tracking_time", "saturation_rate")]
    return Block(
        f"output_{action.name}{'_taking_up' if takes_up else ''}",
        (
            Signal("proportional", description="what does not come from the integral"),
            Signal("increment", description="what the integral gains in automatic"),
            *([Signal("taken_up", description="of a change of gains")] if takes_up else []),
            truth("numbers", "the signals used are numbers"),
            truth("sensors", "their sensors are sound"),
            *OUTPUT_PORTS,
            *own,
        ),
        (Signal("integral", description="integral part of the output"), LAST_OUTPUT),
        output_results(),
        equations,
        ("The output is proportional + integral within its limits.",),
    )


def stage_equations(stages: Sequence[OutputStage], intermediates: Mapping[str, ca.SX]) -> Equations:
    """Return the equations of a law that ends in these output stages.

    Parameters
    ----------
    stages : sequence of OutputStage
    intermediates : mapping
        Names for values before the stages; those of the stages are added.

    Examples
    --------
    >>> stage = OutputStage(Signal("pump"), ca.SX(10), {"pump.integral": ca.SX(7)}, ca.SX(9), {})
    >>> equations = stage_equations([stage], {"error": ca.SX(3)})
    >>> sorted(equations.next_state), sorted(equations.outputs), sorted(equations.intermediates)
    (['pump.integral'], ['pump.out', 'pump.status'], ['error'])
    """
    next_state: dict[str, ca.SX] = {}
    outputs: dict[str, ca.SX] = {}
    named = dict(intermediates)
    for stage in stages:
        next_state |= stage.next_state
        outputs |= as_parts(stage.moved, {"out": stage.manipulated, "status": stage.status})
        named |= stage.intermediates
    return Equations(next_state, outputs, named)
