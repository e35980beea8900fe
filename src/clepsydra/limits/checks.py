"""What cannot be asked of a limit: place, value, what was expected, what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate, pairwise

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import time_text
from clepsydra.limits.event import Event, rest_at
from clepsydra.linear.equilibrium import NoEquilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.ways import in_any_steps, ways
from clepsydra.process.process import Process
from clepsydra.scores.segment import Segment


def check_moved(linear: LinearModel, names: Sequence[str]) -> None:
    """Refuse an output that no input moves.

    Raises
    ------
    InputError
    """
    sizes = map(len, (linear.inputs, linear.states, linear.times, linear.times, linear.outputs))
    u, *_, y = (slice(*ends) for ends in pairwise([0, *accumulate(sizes)]))
    moved = in_any_steps(ways(linear))[y, u]
    for name in names:
        if not moved[linear.outputs.index(name)].any():
            raise InputError(
                f"limit, step of {name}", name, "an output that some input moves",
                "let a pump or valve act on it, or step another setpoint",
            )  # fmt: skip


def rest_asked(
    point: OperatingPoint, setpoints: Mapping[str, float], loads: np.ndarray, segment: Segment
) -> OperatingPoint:
    """Return where a plant rests with the setpoints of an event.

    Raises
    ------
    InputError
        It rests nowhere.
    """
    try:
        return rest_at(point, setpoints, loads)
    except NoEquilibrium as refused:
        name = segment.signal
        raise InputError(
            f"limit, step of {name}", _shown(point.process, name, setpoints[name]),
            f"a setpoint at which the plant can rest: {'; '.join(refused.reasons)}",
            "choose a smaller step",
        ) from None  # fmt: skip


def check_between(event: Event) -> None:
    """Refuse bounds between which the plant does not rest before the event and after it.

    Raises
    ------
    InputError
    """
    for place, signal in enumerate(event.process.inputs):
        if signal.name not in event.bounds:
            continue
        low, high = event.bounds[signal.name]
        rests = [point.inputs[place] for point in (event.start, event.target)]
        if not low <= min(rests) <= max(rests) <= high:
            ends, needed = (
                " to ".join(_shown(event.process, signal.name, value) for value in values)
                for values in ((low, high), sorted(rests))
            )
            raise InputError(
                f"limit, within.{signal.name}", ends,
                f"bounds around what holds the plant at rest, {needed}", "widen them",
            )  # fmt: skip


def too_short(event: Event) -> InputError:
    """Return that nothing brings the plant to rest so soon."""
    return InputError(
        "limit, duration", time_text(event.samples * event.process.sampling_period),
        f"a time in which {event.segment.signal} and all that acts on it can come to rest at the "
        "new setpoint", "lengthen it, or leave it out",
    )  # fmt: skip


def _shown(process: Process, name: str, value: float) -> Finding:
    signal = process.signal(name)
    shown = from_si(value, signal.unit, signal.shown_unit)
    return Finding(f"{shown:.4g} {unit_text(signal.shown_unit)}".strip())
