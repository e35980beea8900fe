"""A transmitter that is stuck: it shows one value while what moves it moves."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Signal, elements
from clepsydra.controllers.alarms.timing import ACTIVE, DELAYS, KEPT, ROUNDING, WATCHED, timed
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import all_of, any_of, is_number, is_time_step
from clepsydra.controllers.signals import GOOD, PV, amount
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

STILL = amount("still", "{measurement}", "by how much {measurement} moves and counts as stuck")
MOVE = amount("move", "{output}", "by how much {output} moves for the measurement to follow")


@cache
def flatline_alarm(count: int) -> Block:
    """Return the block that tells a transmitter that is stuck, by so many inputs of its process.

    Since the measurement moved the last time, by more than what counts as stuck, one of the inputs
    has moved by more than it takes, and the on-delay has gone by since then.

    `count`: of the inputs that are watched.

    Examples
    --------
    A level that stays at 5 while its pump goes from 4 to 6:

    >>> given = dict(pv=5, good=1, still=0, on_delay=0, off_delay=0, time_step=1)
    >>> kept = dict(was_active=0, pending=0, pending_time=0, watches=1, moved=0, last_moved=5)
    >>> given |= {"input.1": 6, "move.1": 0.5}
    >>> kept |= {"held.1": 4}
    >>> found = flatline_alarm(1)("level_1_flatline",
    ...     *({name: ca.DM(value) for name, value in each.items()} for each in (given, kept)))
    >>> bool(found.outputs["active"])
    True
    """
    inputs, moves, held = (elements(name, count) for name in ("input", "move", "held"))
    return Block(
        "flatline_alarm" if count == 1 else f"flatline_alarm_of_{count}_inputs",
        (
            PV.port,
            GOOD.port,
            *(Signal(name, description="what moves the measurement") for name in inputs),
            STILL.port,
            *(replace(MOVE.port, name=name) for name in moves),
            *DELAYS,
        ),
        (
            truth("watches", "there was a measurement"),
            truth("moved", "an input has moved since the measurement did"),
            Signal("last_moved", description="the measurement when it moved the last time"),
            *(Signal(name, description="the input when the measurement moved") for name in held),
            *KEPT,
        ),
        (ACTIVE, WATCHED),
        lambda s: _stuck(s, count),
        ("Alarm where a measurement stands still while an input of its process moves.",),
        (ROUNDING,),
    )


def _stuck(s: Symbols, count: int) -> Equations:
    inputs, moves, held = (elements(name, count) for name in ("input", "move", "held"))
    known = all_of([s["good"], *(is_number(s[name]) for name in ("pv", *inputs))])
    usable = ca.logic_and(known, is_time_step(s["time_step"]))
    follows = ca.fabs(s["pv"] - s["last_moved"]) > s["still"]
    anew = ca.logic_or(ca.logic_not(s["watches"]), follows)
    asked = any_of(
        [
            ca.fabs(s[given] - s[before]) > s[move]
            for given, before, move in zip(inputs, held, moves, strict=True)
        ]
    )
    moved = ca.logic_and(ca.logic_not(anew), ca.logic_or(s["moved"], asked))
    found = timed(s, moved, known)
    takes = ca.logic_and(usable, anew)
    state = {
        "watches": ca.logic_or(s["watches"], usable),
        "moved": ca.if_else(usable, moved, s["moved"]),
        "last_moved": ca.if_else(takes, s["pv"], s["last_moved"]),
        **{
            before: ca.if_else(takes, s[given], s[before])
            for given, before in zip(inputs, held, strict=True)
        },
        **found.next_state,
    }
    named = {"follows": follows, "asked": asked, **found.intermediates}
    return replace(found, next_state=state, intermediates=named)
