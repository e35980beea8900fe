"""An operating point and what the linear model says about it, in a screen."""

from __future__ import annotations

import math

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.report.analysis_tables import analysis_grids, operating_point_grid
from clepsydra.report.facts import gain_text, told_table
from clepsydra.report.quantities import percent_text, quantity_text, time_cell

#: Of the answer: sentences, signals, pairs and warnings.
_SAID, _SIGNALS, _PAIRS, _WATCHED = 5, 6, 4, 3
_DIGITS = 3
_EMPTY = Line("")


def analysis_answer(analysis: Analysis, *, every: bool = False) -> Section:
    """Return what a process means for its control, in about 25 lines of 80 columns.

    Parameters
    ----------
    analysis : Analysis
    every : bool
        Whether with every signal, pole, zero, gain and sentence.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis_answer(cl.load("quadruple-tank").analysis).parts[2].text
    'Pair level_1 with pump_1 (relative gain 1.40), level_2 with pump_2 (relative gain 1.40).'
    """
    point = analysis.operating_point
    words, warnings = analysis.words, point.warnings
    tables = [operating_point_grid(point), *analysis_grids(analysis)]
    parts: list[Line | Table | Section] = []
    if not every:
        words, warnings = words[:_SAID], warnings[:_WATCHED]
        tables = [each for each in (_pairs(analysis), _at_rest(point)) if each is not None]
    parts += marked(Mark.POINT, words)
    parts += marked(Mark.WATCH, warnings)
    for table in tables:
        parts += [_EMPTY, table] if not every else [table]
    more = len(analysis.words) - len(words) + len(point.warnings) - len(warnings)
    if not every:
        said = f"{more} more to know, and every" if more else "Every"
        parts += [_EMPTY, Line(f"{said} signal, pole, zero and gain: --all")]
    following = Line(f"Next: clepsydra study {point.process.address}", Mark.COMMAND)
    return Section(f"{point.process.title} ({point.process.name})", (*parts, following))


def _pairs(analysis: Analysis) -> Table | None:
    """Return gain, relative gain and dead time of the suggested pairs; None without any."""
    process, model, relative = (
        analysis.operating_point.process, analysis.model, analysis.relative_gain_array
    )  # fmt: skip
    if relative is None:
        return None
    rows = []
    for output, name in analysis.pairing[:_PAIRS]:
        place = model.outputs.index(output), model.inputs.index(name)
        gain, late = float(analysis.static_gain[place]), float(analysis.dead_times[place])
        rows.append(
            (
                f"{output} by {name}",
                gain_text(gain, process.signal(name), process.signal(output), _DIGITS)
                if math.isfinite(gain)
                else "integrates",
                f"{relative[place]:.2f}".replace("-", "−"),
                "several" if math.isnan(late) else time_cell(late) if late else "",
            )
        )
    head = ("pair", "static gain", "relative gain", "dead time")
    return told_table(head, rows)


def _at_rest(point: OperatingPoint) -> Table:
    """Return what is controlled, moved and disturbs at the operating point."""
    process, values = point.process, point.as_dict()
    signals = [
        *(process.signal(name) for name in process.controlled),
        *process.inputs,
        *(each for each in process.disturbances if values[each.name]),
    ]
    rows = [
        (
            each.name,
            quantity_text(each, values[each.name], _DIGITS),
            percent_text(process, each.name, values[each.name]),
        )
        for each in signals[:_SIGNALS]
    ]
    return Table("", ("operating point", "value", "of range"), tuple(rows))
