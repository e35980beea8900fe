"""The page of a linear analysis: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.remark import Remark
from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.analysis_words import relative_gain_text
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.report.analysis_pictures import (
    bode_figure,
    directionality_figure,
    nyquist_figure,
    roots_figure,
    step_figure,
)
from clepsydra.report.analysis_tables import (
    analysis_grids,
    further_grids,
    operating_point_grid,
    value_row,
)
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.facts import gain_text, told_table
from clepsydra.report.page import page_text, svg_text
from clepsydra.report.quantities import time_cell
from clepsydra.studies.warnings.out_of_reach import out_of_reach

#: Identifier, title, words, and drawn by.
_PICTURES: tuple[tuple[str, str, str, Callable[[Analysis], Any]], ...] = (
    (
        "steps",
        "Step responses of the linear model",
        "Deviations from the operating point after a step of one input, the others held. A "
        "dotted line marks the end of the dead time.",
        step_figure,
    ),
    (
        "roots",
        "Poles and zeros",
        "Crosses are poles, circles transmission zeros; the right half-plane is shaded.",
        roots_figure,
    ),
    (
        "bode",
        "Frequency response",
        "Magnitude and phase from each input to each output; dotted lines stand at the rates of "
        "the poles. Dead time is exact.",
        bode_figure,
    ),
    (
        "nyquist",
        "Nyquist",
        "The same in the complex plane, in shares of the ranges; small numbers are frequencies "
        "[rad/s]. Dashed: the unit circle; the cross stands at −1.",
        nyquist_figure,
    ),
    (
        "directions",
        "Strong and weak directions, and interaction",
        "Singular values from shares of the inputs' ranges to shares of the outputs' ranges: the "
        "strongest direction dark, weaker ones grey; below one (dashed) a full swing of the "
        "inputs does not cover the range of the outputs. Relative gains of the suggested pairs "
        "are solid; near one the loops do not feel each other.",
        directionality_figure,
    ),
)

_FURTHER = (
    "Reached and shown: the smallest singular value of the test of Popov, Belevitch and Hautus in "
    "shares of the ranges; near one is well, zero not at all. σ: singular values from shares of "
    "the inputs' ranges to shares of the outputs' ranges."
)


def analysis_page_text(analysis: Analysis) -> str:
    """Return the page of an analysis as HTML."""
    point = analysis.operating_point
    pictures = [
        Section(title, (Picture(svg_text(draw(analysis), title, name), words),))
        for name, title, words, draw in _PICTURES
    ]
    at_rest: tuple[Picture | Table, ...] = (
        Picture(process_drawing(point.process, point)),
        operating_point_grid(point),
        *analysis_grids(analysis),
    )
    further: tuple[Line | Table, ...] = (*further_grids(analysis), Line(_FURTHER))
    parts: tuple[Line | Section, ...] = (
        *marked(Mark.POINT, analysis.words),
        *marked(Mark.WATCH, point.warnings),
        Section("The process at its operating point", at_rest),
        *pictures,
        Section("Directions, modes and frequencies", further),
    )
    title = point.process.title or point.process.name
    return page_text(Section(f"{title} – linear analysis", parts))


#: Of the answer: sentences, signals, pairs and warnings.
_SAID, _SIGNALS, _PAIRS, _WATCHED = 5, 6, 4, 3
_EMPTY = Line("")


def analysis_answer(analysis: Analysis, *, every: bool = False) -> Section:
    """Return what a process means for its control, in about 25 lines of 80 columns.

    Parameters
    ----------
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
    parts += marked(Mark.WATCH, [each.brief for each in _out_of_reach(analysis)])
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


def _out_of_reach(analysis: Analysis) -> tuple[Remark, ...]:
    """Return what the steps of a study would ask of final elements that they cannot give."""
    try:
        scenario = default_scenario(analysis.model)
    except InputError:
        # A study says why it has no scenario; an analysis needs none.
        return ()
    return out_of_reach(analysis.model, scenario)


def _pairs(analysis: Analysis) -> Table | None:
    """Return gain, relative gain and dead time of the suggested pairs; None without any."""
    process, model = analysis.operating_point.process, analysis.model
    if analysis.relative_gain_array is None:
        return None
    rows = []
    for pair in analysis.paired_gains[:_PAIRS]:
        output, name = pair.output, pair.input
        place = model.outputs.index(output), model.inputs.index(name)
        gain, late = float(analysis.static_gain[place]), float(analysis.dead_times[place])
        words = "integrates"
        if math.isfinite(gain):
            words = gain_text(gain, process.signal(name), process.signal(output), 3)
        delay = "several" if math.isnan(late) else time_cell(late) if late else ""
        share = relative_gain_text(pair).replace("-", "−")
        rows.append((f"{output} by {name}", words, share, delay))
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
    rows = tuple(value_row(process, each, values[each.name], 3) for each in signals[:_SIGNALS])
    return Table("", ("operating point", "value", "of range"), rows)
