"""A list of the signals and parameters of a controller, for cabinet and screens."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal

_HEAD = ("tag", "direction", "type", "unit", "low", "high", "at the start", "what it is")


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    program, text = delivery.ready.program, io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEAD)
    groups = ("in", program.inputs), ("parameter", program.parameters), ("out", program.outputs)
    for direction, signals in groups:
        writer.writerows(_row(each, direction) for each in signals)
    return ExportedFiles(
        {f"{program.name}_signals.csv": text.getvalue().encode()},
        delivery.ready.facts | options,
        "give it to whoever wires the cabinet and sets up the screens.",
    )


def _row(signal: Signal, direction: str) -> tuple[str, ...]:
    """Return a row, in the unit that the printed program has; what is no bound is left empty."""
    # Numeric, and not needed for a list of targets.
    from clepsydra.controllers.signals import LARGEST_PARAMETER

    truth = signal.kind == "boolean"
    ends = (
        f"{end:.12g}" if not truth and abs(end) < LARGEST_PARAMETER else ""
        for end in (signal.low, signal.high)
    )
    start = str(bool(signal.initial)).lower() if truth else f"{signal.initial:.12g}"
    unit = "" if truth else signal.unit
    return (signal.identifier, direction, signal.kind, unit, *ends, start, signal.description)


TARGETS.add("signals", Target(6, "the list of its signals, as CSV", _controller))
