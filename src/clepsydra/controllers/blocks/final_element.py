"""The end of every law: one manipulated variable with its mode, limits and status word."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.controllers.blocks.handover import Applied, Asked
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.status import status_word
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class FinalElement:
    """An output after mode, limits and rate limit.

    Parameters
    ----------
    manipulated : casadi.SX
        Always a number within the limits.
    applied : Applied
        For what asked.
    status : casadi.SX
        The status word.
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> element = FinalElement(ca.SX(10), Applied(ca.SX(10), ca.SX(1), ca.SX(0)), ca.SX(9), {})
    >>> float(ca.evalf(element.manipulated))
    10.0
    """

    manipulated: ca.SX
    applied: Applied
    status: ca.SX
    named: dict[str, ca.SX]


def final_element(
    symbols: Symbols, number: int, asked: Asked, *, rate_limited: bool = False
) -> FinalElement:
    """Write output `number`: what is asked for in automatic, else what its mode says.

    In manual and tracking the output follows its value. Where an input that the mode uses is
    unusable, the output is held: a failed sensor holds automatic, but an operator can still
    move the output by hand. Limits hold in every mode, and so does the rate limit.

    Parameters
    ----------
    symbols : mapping
        The law's signals by name: last_output_i, mode_i, manual_i, tracking_i, low_limit_i,
        high_limit_i, rate_limit_i (where limited) and time_step.
    number : int
        i, from 1.
    asked : Asked
        In automatic.
    rate_limited : bool

    Examples
    --------
    A law asks for 12 where 10 is the limit: automatic (1) + high limit (8).

    >>> given = dict(last_output=0, mode=1, manual=0, tracking=0, low_limit=0, high_limit=10)
    >>> symbols = {f"{name}_1": ca.DM(value) for name, value in given.items()}
    >>> true = ca.DM(1)
    >>> asked = Asked(ca.DM(12), true, true, true)
    >>> element = final_element(symbols | {"time_step": true}, 1, asked)
    >>> float(element.manipulated), float(ca.evalf(element.status))
    (10.0, 9.0)
    """
    last_output, time_step = symbols[f"last_output_{number}"], symbols["time_step"]
    mode, manual = symbols[f"mode_{number}"], symbols[f"manual_{number}"]
    tracking = symbols[f"tracking_{number}"]
    low, high = symbols[f"low_limit_{number}"], symbols[f"high_limit_{number}"]

    in_manual, in_automatic = mode == Mode.MANUAL, mode == Mode.AUTOMATIC
    in_tracking = mode == Mode.TRACKING
    time_step_good = is_time_step(time_step)
    # The last test meets parameters that were changed to something unusable at run time.
    usable = ca.logic_and(ca.logic_and(asked.usable, time_step_good), is_number(asked.value))
    controls = ca.logic_and(in_automatic, usable)
    by_hand = ca.logic_and(in_manual, is_number(manual))
    tracks = ca.logic_and(in_tracking, is_number(tracking))
    follows = ca.logic_or(by_hand, tracks)

    wanted = ca.if_else(tracks, tracking, last_output)
    wanted = ca.if_else(by_hand, manual, wanted)
    wanted = ca.if_else(controls, asked.value, wanted)
    manipulated = limit(wanted, low, high)
    hurried = ca.SX(0)
    if rate_limited:
        step = symbols[f"rate_limit_{number}"] * ca.if_else(time_step_good, time_step, 0)
        slowed = limit(manipulated, last_output - step, last_output + step)
        hurried = slowed != manipulated
        manipulated = limit(slowed, low, high)
    # A limit of minus infinity at run time is none that an actuator could be brought to.
    manipulated = ca.if_else(is_number(manipulated), manipulated, last_output)

    input_unusable = ca.logic_or(
        ca.logic_not(asked.numbers), ca.logic_not(ca.logic_or(in_automatic, follows))
    )
    conditions = {
        "automatic": in_automatic,
        "tracking": in_tracking,
        "at_low_limit": manipulated <= low,
        "at_high_limit": manipulated >= high,
        "sensor_fault": ca.logic_not(asked.sensors),
        "invalid_input": input_unusable,
        "invalid_time_step": ca.logic_not(time_step_good),
        "at_rate_limit": hurried,
    }
    named = {
        f"in_automatic_{number}": in_automatic,
        f"in_tracking_{number}": in_tracking,
        f"controls_{number}": controls,
        f"by_hand_{number}": by_hand,
        f"follows_{number}": follows,
        f"wanted_{number}": wanted,
        "time_step_good": time_step_good,
    }
    applied = Applied(manipulated, controls, follows)
    return FinalElement(manipulated, applied, status_word(conditions), named)
