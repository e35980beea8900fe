"""The output stage that every law ends in: mode, limits, anti-windup, hold and status."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.anti_windup import (
    AntiWindup,
    back_calculation,
    conditional_integration,
    tracking_share,
)
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode, followed_integral
from clepsydra.controllers.blocks.status import status_word
from clepsydra.controllers.blocks.validity import is_number, is_time_step
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
    under the anti-windup rule. In manual and tracking the output follows its value and the
    integral follows the output, so that automatic continues from there. Where an input that
    the mode uses is unusable, the output is held and the integral frozen: a failed sensor
    holds automatic, but an operator can still move the output by hand.

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
    anti_windup : {"back_calculation", "conditional_integration"}

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
    integral, last_output = symbols[f"integral_{number}"], symbols[f"last_output_{number}"]
    mode, manual = symbols[f"mode_{number}"], symbols[f"manual_{number}"]
    tracking, time_step = symbols[f"tracking_{number}"], symbols["time_step"]
    low, high = symbols[f"low_limit_{number}"], symbols[f"high_limit_{number}"]

    in_manual, in_automatic = mode == Mode.MANUAL, mode == Mode.AUTOMATIC
    in_tracking = mode == Mode.TRACKING
    unlimited = proportional + integral
    signals_known = ca.logic_and(signals_are_numbers, sensors_are_good)
    time_step_good = is_time_step(time_step)

    # The last test meets parameters that were changed to something unusable at run time.
    law_usable = ca.logic_and(ca.logic_and(signals_known, time_step_good), is_number(unlimited))
    controls = ca.logic_and(in_automatic, law_usable)
    by_hand = ca.logic_and(in_manual, is_number(manual))
    tracks = ca.logic_and(in_tracking, is_number(tracking))
    follows = ca.logic_or(by_hand, tracks)

    asked = ca.if_else(tracks, tracking, last_output)
    asked = ca.if_else(by_hand, manual, asked)
    asked = ca.if_else(controls, unlimited, asked)
    manipulated = limit(asked, low, high)

    integrated = _integrated(symbols, number, increment, unlimited, manipulated, anti_windup)
    followed = followed_integral(integral, manipulated, last_output, proportional, signals_known)
    next_integral = ca.if_else(controls, integrated, ca.if_else(follows, followed, integral))
    # An increment beyond the range of numbers is not taken.
    kept_integral = ca.if_else(is_number(next_integral), next_integral, integral)

    input_unusable = ca.logic_or(
        ca.logic_not(signals_are_numbers),
        ca.logic_not(ca.logic_or(in_automatic, follows)),
    )
    conditions = {
        "automatic": in_automatic,
        "tracking": in_tracking,
        "at_low_limit": manipulated <= low,
        "at_high_limit": manipulated >= high,
        "sensor_fault": ca.logic_not(sensors_are_good),
        "invalid_input": input_unusable,
        "invalid_time_step": ca.logic_not(time_step_good),
    }
    intermediates = {
        f"in_automatic_{number}": in_automatic,
        f"in_tracking_{number}": in_tracking,
        f"signals_known_{number}": signals_known,
        f"unlimited_{number}": unlimited,
        f"controls_{number}": controls,
        f"by_hand_{number}": by_hand,
        f"follows_{number}": follows,
        f"asked_{number}": asked,
        f"followed_{number}": followed,
        f"next_integral_{number}": next_integral,
        "time_step_good": time_step_good,
    }
    return OutputStage(number, manipulated, kept_integral, status_word(conditions), intermediates)


def _integrated(
    symbols: Symbols,
    number: int,
    increment: ca.SX,
    unlimited: ca.SX,
    limited: ca.SX,
    anti_windup: AntiWindup,
) -> ca.SX:
    """Return the integral after a sample in automatic."""
    integral = symbols[f"integral_{number}"]
    if anti_windup == "conditional_integration":
        return conditional_integration(integral, increment, unlimited, limited)
    share = tracking_share(symbols["time_step"], symbols[f"tracking_time_{number}"])
    return back_calculation(integral, increment, unlimited, limited, share)


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
