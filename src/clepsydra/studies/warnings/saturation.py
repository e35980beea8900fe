"""Warnings of pumps and valves that stand at a limit: at rest, after a step, or in a run."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.scores.effort import at_limit
from clepsydra.studies.warnings.resting import Rest
from clepsydra.studies.warnings.wind_up import winds_up
from clepsydra.studies.warnings.words import shown

#: An input that rests within this share of its range of a limit has no room.
_NO_ROOM = 0.02
#: And within this share it is at the limit: less is rounding.
_AT_LIMIT = 1e-6
#: Share of a run at a limit above which the reader is told, and above which it is most of it.
_SATURATED = 0.05
MOSTLY = 0.5


def resting_saturation_words(
    controller: Controller, point: OperatingPoint, rests: list[Rest]
) -> list[str]:
    """Return in sentences which manipulated variables have no room, before simulating.

    One that rests within 2 % of a limit at the operating point; and one that would have to rest
    beyond a limit, by the linear model, to hold a setpoint or a load of the scenario.

    Parameters
    ----------
    rests : list of Rest
        Of `resting_after`.
    """
    process, at, words = point.process, point.as_dict(), []
    for name in controller.manipulated:
        signal = process.signal(name)
        if not np.isfinite(signal.span):
            continue
        end = _nearer_end(signal, at[name])
        if abs(at[name] - end) <= _NO_ROOM * signal.span:
            words.append(_without_room(name, at[name], end, signal))
            continue
        for rest in rests:
            value = rest.values[name]
            if not signal.low <= value <= signal.high:
                segment = rest.segment
                stepped = process.signal(segment.signal)
                words.append(
                    f"{name} saturates: to hold the {segment.kind} step of {segment.signal} by "
                    f"{shown(segment.size, stepped)} it would have to rest at about "
                    f"{shown(value, signal)}, beyond {shown(_nearer_end(signal, value), signal)}; "
                    "make the step smaller, or give it another size."
                )
                break
    return words


def saturation_warnings(run: Run) -> list[str]:
    """Return warnings of inputs that stood at a limit in a run, for how long and with what effect.

    More than 5 % of the time is told; more than half of it is most of the time. An integral
    without anti-windup (see `winds_up`) is told wherever its output stood at a limit at all.
    """
    if not run.controller.setpoints:  # pumps that start and stop stand at their limits
        return []
    words, shares = [], {}
    for signal in run.process.inputs:
        low, high = run.limits(signal.name)
        share, mostly_low = share_at_limit(run.values[signal.name], low, high)
        shares[signal.name] = share
        if share > _SATURATED:
            end = low if mostly_low else high
            effect = (
                "nothing is controlled for most of it; ask for less, or give it another size"
                if share > MOSTLY
                else "nothing is corrected meanwhile"
            )
            words.append(
                f"{signal.name} stands at a limit for {100 * share:.0f} % of the time, mostly at "
                f"{shown(end, signal)}: {effect}."
            )
    if any(shares[name] > 0.0 for name in run.controller.manipulated):
        words += _wound_up(run, shares)
    return words


def share_at_limit(values: np.ndarray, low: float, high: float) -> tuple[float, bool]:
    """Return for which share of samples values are at a limit, and whether mostly at the low one.

    Examples
    --------
    >>> share_at_limit(np.array([0.0, 0.0, 4.0, 10.0]), 0.0, 10.0)
    (0.75, True)
    """
    share = float(np.mean(at_limit(values, low, high)))
    return share, float(np.mean(at_limit(values, low, np.inf))) > share / 2.0


def _wound_up(run: Run, shares: dict[str, float]) -> list[str]:
    return [
        f"{name} winds up: its integral has no anti-windup and went on while it stood at a limit, "
        f"for {100 * shares[name]:.2g} % of the time; choose conditional integration or "
        "back-calculation."
        for name in winds_up(run.controller, run.process)
        if shares[name] > 0.0
    ]


def _without_room(name: str, rest: float, end: float, signal: Signal) -> str:
    """Return what is missing: all of the room in one direction, or all but a little."""
    room = abs(rest - end)
    where, effect = f"at its limit of {shown(end, signal)}", "corrects nothing"
    if room > _AT_LIMIT * signal.span:
        where = f"near its limit of {shown(end, signal)}"
        effect = "can correct hardly anything"
    way = "downward" if end == signal.low else "upward"
    return (
        f"{name} rests at {shown(rest, signal)}, {where}: {way} it {effect}; move the operating "
        "point, or give it another size."
    )


def _nearer_end(signal: Signal, value: float) -> float:
    return signal.low if value - signal.low < signal.high - value else signal.high
