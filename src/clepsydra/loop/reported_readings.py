"""What sensors with dead time and sampling tell: readings that are held beside the loop."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.process.process import Process
from clepsydra.process.reporting import ReportedSamples
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.reader import inline

#: Of a measurement: readings that are not told yet, what was told last, and how long from then on
#: to the next report.
ON_ITS_WAY, TOLD, WAIT = "on_its_way", "told", "wait"


def reported_samples(process: Process) -> dict[str, ReportedSamples]:
    """Return the measurements of a process that are told late or seldom, and how.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> reported_samples(load_process("quadruple-tank"))
    {}
    """
    period = process.sampling_period
    return {name: each.samples(period) for name, each in process.reporting.items()}


def reporting_state(process: Process) -> tuple[Signal | DelayRing, ...]:
    """Return what lives from sample to sample of measurements that are told late or seldom.

    Of y "y.told"; with a dead time the ring "y.on_its_way", as many readings as it has samples, so
    that a delay costs memory and no integration step; of one that is told at times "y.wait".

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> reporting_state(load_process("quadruple-tank"))
    ()
    """
    found: list[Signal | DelayRing] = []
    for name, samples in reported_samples(process).items():
        y = process.signal(name)
        if samples.late:
            ring = Signal(path(name, ON_ITS_WAY), y.unit, y.display_unit)
            found.append(DelayRing(ring, samples.late))
        found.append(Signal(path(name, TOLD), y.unit, y.display_unit))
        if samples.every > 1:
            found.append(Signal(path(name, WAIT), kind="integer", low=0.0))
    return tuple(found)


def held_names(process: Process) -> list[str]:
    """Return the names of these states but for the rings."""
    return [each.name for each in reporting_state(process) if isinstance(each, Signal)]


def reporting_at(
    process: Process, shown: Mapping[str, float], *, asked: bool = False, steps: int = 1
) -> dict[str, float]:
    """Return these states by name where sensors have shown the same for ever.

    Parameters
    ----------
    shown : mapping
        Measurement to what it shows [SI].
    asked : bool
        Sample 0 is over, and sample 1 comes next.
    steps : int
        As for `append_reported`.
    """
    found: dict[str, float] = {}
    for name, samples in reported_samples(process).items():
        if samples.late:
            found[path(name, ON_ITS_WAY)] = shown[name]
        found[path(name, TOLD)] = shown[name]
        if samples.every > 1:
            wait = (samples.first or samples.every) if asked else samples.first + 1
            found[path(name, WAIT)] = float(steps * wait)
    return found


def told_at(
    process: Process, shown: Mapping[str, float], held: Mapping[str, float]
) -> dict[str, float]:
    """Return what controllers see in the next sample of what sensors show in it.

    Parameters
    ----------
    shown : mapping
        Measurement to what its sensor shows [SI].
    held : mapping
        States of `reporting_state` by name; of a ring the oldest reading.
    """
    told = dict(shown)
    for name, samples in reported_samples(process).items():
        if samples.late:
            told[name] = held[path(name, ON_ITS_WAY)]
        if samples.every > 1 and held[path(name, WAIT)] > 1.0:
            told[name] = held[path(name, TOLD)]
    return told


def append_reported(
    builder: BlockBuilder,
    process: Process,
    value: Mapping[str, int],
    shown: Mapping[str, int],
    steps: int = 1,
) -> tuple[dict[str, int], list[int]]:
    """Append what controllers see to a program.

    Parameters
    ----------
    builder : BlockBuilder
    value : mapping
        States of `reporting_state` by name.
    shown : mapping
        Measurement to what its sensor shows.
    steps : int
        In a sampling period, in which the time to the next report is counted.

    Returns
    -------
    told : dict
        Measurement that is told late or seldom to what is told of it.
    following : list of int
        The next states, in their order.
    """
    told, following = dict[str, int](), list[int]()
    for name, samples in reported_samples(process).items():
        seen, waits = shown[name], list[int]()
        if samples.late:
            following.append(seen)
            seen = value[path(name, ON_ITS_WAY)]
        if samples.every > 1:
            held = [value[path(name, part)] for part in (TOLD, WAIT)]
            seen, *waits = inline(builder, _report(samples.every, steps), [seen, *held])
        told[name] = seen
        following += [seen, *waits]
    return told, following


def _report(every: int, steps: int) -> ca.Function:
    """Return (reading, told before, steps to the next report) → (told now, steps from now on)."""
    reading, told, wait = ca.SX.sym("reading"), ca.SX.sym("told"), ca.SX.sym("wait")
    left = wait - steps
    due = left <= 0.0
    found = ca.vertcat(ca.if_else(due, reading, told), ca.if_else(due, every * steps, left))
    return ca.Function("report", [ca.vertcat(reading, told, wait)], [found])
