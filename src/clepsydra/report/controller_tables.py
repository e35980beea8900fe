"""Parameters and status words of a controller as text."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.status import STATUS_BITS, read_status
from clepsydra.controllers.controller import Controller
from clepsydra.loop.run import Run
from clepsydra.report.quantities import number_text, unit_text


@dataclass(frozen=True)
class ParameterTable:
    """Parameters that share their columns.

    Parameters
    ----------
    columns : tuple of str
        Last index of the parameters' names; one empty text for those without an index.
    rows : tuple of (name, unit, values)
        One value for each column.

    Examples
    --------
    >>> table = ParameterTable(("1", "2"), (("integral_time", "s", ("30.00", "40.00")),))
    >>> dict(zip(table.columns, table.rows[0][2]))
    {'1': '30.00', '2': '40.00'}
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, str, tuple[str, ...]], ...]


def parameter_tables(controller: Controller) -> list[ParameterTable]:
    """Return the parameters of a controller, grouped by what their last index counts.

    "integral_time_1" and "integral_time_2" become the row "integral_time" with columns 1 and 2;
    "feedback_2_3" stands in the row "feedback_2", column 3.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> [table.columns for table in parameter_tables(controller)]
    [('1', '2')]
    """
    units = {signal.name: signal.unit for signal in controller.law.parameters}
    grouped: dict[tuple[str, str], dict[str, float]] = {}
    for name, value in controller.values.items():
        stem, _, index = name.rpartition("_")
        stem, index = (stem, index) if index.isdigit() else (name, "")
        grouped.setdefault((stem, units.get(name, "1")), {})[index] = value
    tables: dict[tuple[str, ...], list[tuple[str, str, tuple[str, ...]]]] = {}
    # Rows of one matrix, feedback_1 and feedback_2, follow each other.
    firsts: dict[str, int] = {}
    for stem, _ in grouped:
        firsts.setdefault(stem.rstrip("0123456789"), len(firsts))
    for stem, unit in sorted(grouped, key=lambda key: firsts[key[0].rstrip("0123456789")]):
        values = grouped[stem, unit]
        numbers = tuple(number_text(value, 4) for value in values.values())
        tables.setdefault(tuple(values), []).append((stem, unit_text(unit), numbers))
    return [ParameterTable(columns, tuple(rows)) for columns, rows in tables.items()]


def status_words(run: Run) -> list[str]:
    """Return what the status words told, and for how long; outputs that told the same together.

    Parameters
    ----------
    run : Run

    Returns
    -------
    list of str
        "pump_1, pump_2: the mode is automatic (14 min); the output stands at its high
        limit (12 s)"

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> status_words(run)[0].split(" (")[0]
    'pump_1, pump_2: the mode is automatic'
    """
    outputs: dict[str, list[str]] = {}
    for name in run.controller.manipulated:
        seconds = dict.fromkeys(STATUS_BITS, 0.0)
        for word, samples in zip(
            *np.unique(run.values[f"{name}.status"], return_counts=True), strict=True
        ):
            for bit in read_status(int(word)):
                seconds[bit] += float(samples) * run.scenario.sampling_period
        told = [
            f"{STATUS_BITS[bit].meaning} ({time_text(duration)})"
            for bit, duration in seconds.items()
            if duration
        ]
        words = "; ".join(told) or "the mode is manual, nothing else to tell"
        outputs.setdefault(words, []).append(name)
    return [f"{', '.join(names)}: {words}" for words, names in outputs.items()]
