"""A list of the signals of a controller, for who wires the cabinet and sets up the screens."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING

from clepsydra.base.units import from_si
from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal

_HEAD = ("tag", "direction", "type", "unit", "low", "high", "what it is")


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    program, text = delivery.ready.program, io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEAD)
    for direction, signals in (("in", program.inputs), ("out", program.outputs)):
        for each in signals:
            if not each.record:
                writer.writerow(_row(each, direction))
    return ExportedFiles(
        {f"{program.name}_signals.csv": text.getvalue().encode()},
        delivery.ready.facts | options,
        "give it to who wires the cabinet and sets up the screens.",
    )


def _row(signal: Signal, direction: str) -> tuple[str, ...]:
    ends = (
        f"{from_si(end, signal.unit, signal.shown_unit):.6g}" if math.isfinite(end) else ""
        for end in (signal.low, signal.high)
    )
    return (signal.identifier, direction, signal.kind, signal.shown_unit, *ends, signal.description)


TARGETS.add("signals", Target(5, "the list of its signals, as CSV", _controller))
