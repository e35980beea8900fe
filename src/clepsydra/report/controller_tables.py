"""Parameters and status words of a controller as text."""

from __future__ import annotations

import numpy as np

from clepsydra.base.section import Table
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.status import STATUS_BITS, read_status
from clepsydra.controllers.controller import Controller
from clepsydra.loop.run import Run
from clepsydra.report.quantities import number_text, unit_text


def parameter_tables(controller: Controller) -> list[Table]:
    """Return the parameters of a controller, those that many things have in columns.

    "level_1.integral_time" and "level_2.integral_time" become the row "integral_time" with columns
    level_1 and level_2; "pump_1.feedback.level_3" stands in the row "pump_1.feedback", column
    level_3.

    Examples
    --------
    >>> import clepsydra as cl
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> [table.head[1:-1] for table in parameter_tables(controller)]
    [('level_1', 'level_2'), ('pump_1', 'pump_2')]
    """
    units = {signal.name: signal.unit for signal in controller.law.parameters}
    grouped: dict[tuple[str, str], dict[str, float]] = {}
    for name, value in controller.values.items():
        owner, part, element = [*name.split(".", 2), "", ""][:3]
        row, column = (f"{owner}.{part}", element) if element else (part or owner, part and owner)
        grouped.setdefault((row, units.get(name, "1")), {})[column] = value
    tables: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    for (row, unit), values in grouped.items():
        numbers = tuple(number_text(value, 4) for value in values.values())
        tables.setdefault(tuple(values), []).append((row, *numbers, unit_text(unit)))
    return [Table("", ("", *columns, "unit"), tuple(rows)) for columns, rows in tables.items()]


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
