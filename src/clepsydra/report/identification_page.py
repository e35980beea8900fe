"""The page of an identification: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.section import Line, Mark, Picture, Section, marked
from clepsydra.base.words import time_text
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.identification.ranking import RANKING_RULE
from clepsydra.report.facts import facts_table
from clepsydra.report.html import address_text, versions_text
from clepsydra.report.identification_picture import (
    ComparedSignal,
    comparison_figure,
    correlations_figure,
)
from clepsydra.report.identification_tables import what_was_found
from clepsydra.report.page import page_text, write_page
from clepsydra.report.svg import svg_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COMPARED = (
    "Grey: measured. Coloured: simulated from the inputs alone, the best model solid. Shaded: the "
    "last third, which no fit has seen."
)
_CORRELATED = (
    "Correlations of the residuals of the first two thirds. Shaded: the band that holds 95 of 100 "
    "of them where residuals are white and free of the input."
)
_TESTS = (
    "White: whether the residuals say nothing about the next ones. Free of input: whether earlier "
    "inputs say nothing about them. Both are Lagrange-multiplier tests; p is the probability of so "
    "strong a sign by chance, and “no” stands below 0.01."
)
_FIT_WORDS = (
    "The parameters and the states at the first row are those with which the simulated "
    "measurements are nearest to the first two thirds of the record, each measurement weighed by "
    "what is left of it. The last third was not seen: it is simulated on from the inputs alone. "
    "The fit is 100 % − the error in percent of the error of a constant, the mean of the first "
    "two thirds."
)


def write_identification_page(found: Identification | ProcessFit, path: str | Path) -> None:
    """Write the page of an identification; an existing file is replaced only by a whole one.

    Parameters
    ----------
    found : Identification or ProcessFit
    path : str or Path
        An HTML file.

    Raises
    ------
    InputError
        The folder cannot be written to.

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_identification_page(found, Path(folder, "page.html"))
    ...     found.verdict[:9] in Path(folder, "page.html").read_text("utf-8")
    True
    """
    write_page(identification_text(found), path)


def identification_text(found: Identification | ProcessFit) -> str:
    """Return the page of an identification as HTML.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.process_fit import fit_process
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> page = identification_text(fit_process(run.process, record_of(run), ["outlet_1.area"]))
    >>> page.count("<svg"), "outlet_1.area" in page
    (2, True)
    """
    if isinstance(found, Identification):
        return _of_models(found)
    return _of_process(found)


def _of_models(found: Identification) -> str:
    record, best = found.record, found.best
    models = tuple((model.name, model.simulated) for model in found.models)
    moved = record.values[found.manipulated.name]
    signals = [
        ComparedSignal(found.output, record.values[found.output.name], models),
        ComparedSignal(found.manipulated, moved),
    ]
    earlier = moved[record.held_back - len(best.residuals) : record.held_back]
    return _page(
        found,
        f"{found.output.name} by {found.manipulated.name}",
        (Line(found.control_words), *_watched(found.warnings)),
        signals,
        f"The residuals of {best.name} are {best.tests.words}.",
        correlations_figure(best.residuals, [(found.manipulated.name, earlier)]),
        RANKING_RULE,
        [(f"{model.name}, {model.title}", model.formula) for model in found.models],
    )


def _of_process(fit: ProcessFit) -> str:
    record, process = fit.record, fit.process
    signals = [
        ComparedSignal(output.signal, output.measured, (("simulated", output.simulated),))
        for output in fit.outputs
    ]
    outside = [s for s in (*process.inputs, *process.disturbances) if s in record.signals]
    moving = [(s, record.values[s.name]) for s in outside if np.ptp(record.values[s.name]) > 0.0]
    signals += [ComparedSignal(signal, values) for signal, values in moving]
    worst, count = fit.worst or fit.outputs[0], record.held_back
    left = worst.measured[:count] - worst.simulated[:count]
    return _page(
        fit,
        f"{process.title}, parameters from a record",
        _watched(fit.notes),
        signals,
        f"The residuals of {worst.signal.name} are {worst.tests.words}.",
        correlations_figure(left, [(signal.name, values[:count]) for signal, values in moving]),
        _FIT_WORDS,
        [("process file", address_text(process))],
    )


def _watched(warnings: Iterable[str]) -> tuple[Line, ...]:
    return marked(Mark.WATCH, (f"{words}." for words in warnings))


def _page(
    found: Identification | ProcessFit,
    title: str,
    said: Sequence[Line],
    signals: Sequence[ComparedSignal],
    residuals: str,
    correlations: Figure,
    rule: str,
    origin: Sequence[tuple[str, str]],
) -> str:
    record = found.record
    facts = [
        ("record", record.place),
        ("rows", f"{record.samples}, one each {time_text(record.period, 4)}"),
        ("held back", f"from {time_text(float(record.time[record.held_back]), 4)} on"),
        *origin,
        ("versions", versions_text()),
    ]
    compared = comparison_figure(record.time, record.held_back, signals)
    left = svg_text(correlations, "Correlations of the residuals", "correlations")
    return page_text(
        Section(
            f"{title} – identification",
            (
                Line(found.verdict, Mark.ANSWER),
                *said,
                Picture(svg_text(compared, "Measured and simulated", "comparison"), _COMPARED),
                Section("What was found", (*what_was_found(found), Line(rule))),
                Section(
                    "What is left", (Line(residuals), Picture(left, _CORRELATED), Line(_TESTS))
                ),
                Section("How this was computed", (facts_table("", facts),)),
            ),
        )
    )
