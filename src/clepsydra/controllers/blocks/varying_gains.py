"""LQI whose gains change from sample to sample, without a bump."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.output_stage import OutputStage, output_stage
from clepsydra.program.step_law import Symbols

#: Rows of gains, one for each output.
Gains = Sequence[Sequence[ca.SX]]


class Feedback(NamedTuple):
    """What an LQI law computes with in a sample.

    Parameters
    ----------
    state : list of casadi.SX [n]
        Deviations x of the states, always numbers.
    errors : dict [q]
        e = r − y by name, always numbers.
    numbers, sensors : casadi.SX
        Whether all signals behind them are numbers, and their sensors sound.

    Examples
    --------
    >>> true = ca.SX(1)
    >>> Feedback([ca.SX(0.5)], {"level.error": ca.SX(1)}, true, true).errors
    {'level.error': SX(1)}
    """

    state: list[ca.SX]
    errors: dict[str, ca.SX]
    numbers: ca.SX
    sensors: ca.SX


def varying_lqi(
    symbols: Symbols,
    moved: Sequence[Signal],
    feedback: Feedback,
    gains: Gains,
    former: Gains | None,
    integral_gains: Gains,
    anti_windup: AntiWindup,
) -> tuple[list[OutputStage], dict[str, ca.SX]]:
    """Return the output stages of u = u° − F x + I whose gains F and G may change.

    The integral takes up what a change of F makes of −F x, I + (F − F₋) x, so that a change of
    the gains alone moves nothing: between two samples u moves by −F₋ Δx + Δt G e. This is the
    velocity form of a scheduled controller, whose linear model at each point is the one that was
    designed there, and which needs no table of the outputs at rest.

    Parameters
    ----------
    symbols : mapping
        integral and bias of each output, time_step and what `blocks.output_stage` reads.
    moved : sequence of Signal [m]
        The process inputs.
    feedback : Feedback
    gains, former : sequence of sequences [m][n]
        F in this sample and in the last one; None where F never changes.
    integral_gains : sequence of sequences [m][q]
        G
    anti_windup : AntiWindup

    References
    ----------
    I. Kaminer, A. M. Pascoal, P. P. Khargonekar and E. E. Coleman, A velocity algorithm for the
    implementation of gain-scheduled controllers, Automatica 31(8), 1995, 1185-1191,
    doi 10.1016/0005-1098(95)00026-S.

    Examples
    --------
    F went from 1 to 2 at a deviation of 3; the output is that of F = 1:

    >>> given = dict(integral=4, last_output=1, mode=1, manual=0, tracking=0, low_limit=-9,
    ...              high_limit=9, bias=0)
    >>> symbols = {f"pump.{name}": ca.DM(value) for name, value in given.items()}
    >>> true = ca.DM(1)
    >>> stages, _ = varying_lqi(
    ...     symbols | {"time_step": true}, [Signal("pump")],
    ...     Feedback([ca.DM(3)], {"error": ca.DM(0)}, true, true), [[ca.DM(2)]], [[ca.DM(1)]],
    ...     [[ca.DM(1)]], "none")
    >>> float(stages[0].manipulated), float(stages[0].next_state["pump.integral"])
    (1.0, 7.0)
    """
    stages, named = [], dict(feedback.errors)
    errors = list(feedback.errors.values())
    for place, (u, row, integral_row) in enumerate(zip(moved, gains, integral_gains, strict=True)):
        fed_back = _sum(row, feedback.state)
        rate = _sum(integral_row, errors)
        named |= {path(u, "fed_back"): fed_back, path(u, "integral_rate"): rate}
        taken_up = None
        if former is not None:
            taken_up = fed_back - _sum(former[place], feedback.state)
            named[path(u, "taken_up")] = taken_up
        stages.append(
            output_stage(
                symbols,
                u,
                proportional=symbols[path(u, "bias")] - fed_back,
                increment=symbols["time_step"] * rate,
                signals_are_numbers=feedback.numbers,
                sensors_are_good=feedback.sensors,
                anti_windup=anti_windup,
                taken_up=taken_up,
            )
        )
    return stages, named


def _sum(row: Sequence[ca.SX], values: Sequence[ca.SX]) -> ca.SX:
    total = row[0] * values[0]
    for gain, value in zip(row[1:], values[1:], strict=True):
        total = total + gain * value
    return total
