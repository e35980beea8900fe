"""The output stage of a law with one integral for each output: anti-windup, mode, limits, hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked, Limits
from clepsydra.controllers.blocks.integral import IntegralAction
from clepsydra.program.step_law import Equations, Symbols


@dataclass(frozen=True)
class OutputStage:
    """One output of a law after its output stage.

    Parameters
    ----------
    number : int
        i, from 1.
    manipulated : casadi.SX
        The output, always a number within its limits.
    integral : casadi.SX
        The next value of the integral, always a number.
    status : casadi.SX
        The status word.
    intermediates : dict
        Names for values on the way, which a printed program uses.

    Examples
    --------
    >>> stage = OutputStage(2, ca.SX(10), ca.SX(7), ca.SX(9), {})
    >>> float(ca.evalf(stage.manipulated)), stage.number
    (10.0, 2)
    """

    number: int
    manipulated: ca.SX
    integral: ca.SX
    status: ca.SX
    intermediates: dict[str, ca.SX]


def output_stage(
    symbols: Symbols,
    number: int,
    *,
    proportional: ca.SX,
    increment: ca.SX,
    signals_are_numbers: ca.SX,
    sensors_are_good: ca.SX,
    anti_windup: AntiWindup,
) -> OutputStage:
    """Write the output stage of output `number`.

    In automatic the output is proportional + integral, and the integral takes its increment
    under the anti-windup rule (`blocks.integral`). The other modes, limits and faults are those
    of every output (`blocks.final_element`).

    Parameters
    ----------
    symbols : mapping
        The law's signals by name: integral_i, last_output_i, mode_i, manual_i, tracking_i,
        low_limit_i, high_limit_i, tracking_time_i (back-calculation), time_step.
    number : int
        i, from 1.
    proportional : casadi.SX
        The part of the output that does not come from the integral, in its unit.
    increment : casadi.SX
        What the integral gains in this sample in automatic, in the unit of the output.
    signals_are_numbers, sensors_are_good : casadi.SX
        Whether the setpoints and measurements used are numbers, and their sensors sound.
    anti_windup : AntiWindup

    Examples
    --------
    An output that asks for 12 stands at its high limit of 10: automatic (1) + high limit (8).

    >>> given = dict(integral=7, last_output=0, mode=1, manual=0, tracking=0, low_limit=0,
    ...              high_limit=10)
    >>> symbols = {f"{name}_1": ca.DM(value) for name, value in given.items()}
    >>> true = ca.DM(1)
    >>> stage = output_stage(symbols | {"time_step": true}, 1, proportional=ca.DM(5),
    ...                      increment=ca.DM(1), signals_are_numbers=true, sensors_are_good=true,
    ...                      anti_windup="conditional_integration")
    >>> float(stage.manipulated), float(stage.integral), float(ca.evalf(stage.status))
    (10.0, 7.0, 9.0)
    """
    integral = symbols[f"integral_{number}"]
    unlimited = proportional + integral
    known = ca.logic_and(signals_are_numbers, sensors_are_good)
    element = final_element(
        symbols, number, Asked(unlimited, known, signals_are_numbers, sensors_are_good)
    )
    action = IntegralAction(
        integral=integral,
        proportional=proportional,
        increment=increment,
        known=known,
        last_applied=symbols[f"last_output_{number}"],
        anti_windup=anti_windup,
        time_step=symbols["time_step"],
        tracking_time=symbols.get(f"tracking_time_{number}"),
        limits=Limits(symbols[f"low_limit_{number}"], symbols[f"high_limit_{number}"]),
    )
    named = {f"signals_known_{number}": known, f"unlimited_{number}": unlimited} | element.named
    return OutputStage(
        number, element.manipulated, action.following(element.applied), element.status, named
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
    >>> stage = OutputStage(1, ca.SX(10), ca.SX(7), ca.SX(9), {"unlimited_1": ca.SX(12)})
    >>> equations = stage_equations([stage], {"error_1": ca.SX(3)})
    >>> sorted(equations.next_state), sorted(equations.outputs), sorted(equations.intermediates)
    (['integral_1', 'last_output_1'], ['manipulated_1', 'status_1'], ['error_1', 'unlimited_1'])
    """
    next_state: dict[str, ca.SX] = {}
    outputs: dict[str, ca.SX] = {}
    named = dict(intermediates)
    for stage in stages:
        next_state[f"integral_{stage.number}"] = stage.integral
        next_state[f"last_output_{stage.number}"] = stage.manipulated
        outputs[f"manipulated_{stage.number}"] = stage.manipulated
        outputs[f"status_{stage.number}"] = stage.status
        named |= stage.intermediates
    return Equations(next_state, outputs, named)
