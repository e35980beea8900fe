"""What an identification found: its answer, its tables, and its page without a script."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text
from clepsydra.identification.estimate import Estimate
from clepsydra.identification.fitted_model import FittedModel
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import OutputFit, ProcessFit
from clepsydra.identification.ranking import RANKING_RULE
from clepsydra.identification.residual_tests import ResidualTests
from clepsydra.report.facts import facts_table
from clepsydra.report.html import address_text, versions_text
from clepsydra.report.identification_picture import (
    ComparedSignal,
    comparison_figure,
    correlations_figure,
)
from clepsydra.report.page import page_text, svg_text
from clepsydra.report.quantities import (
    number_text,
)

#: Of the answer: parameters of a process, and warnings.
_FITTED, _WATCHED = 6, 2
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


def identification_text(found: Identification | ProcessFit) -> str:
    """Return the page of an identification as HTML."""
    record, held = found.record, found.record.held_back
    said = [Line(found.verdict, Mark.ANSWER)]
    if isinstance(found, Identification):
        best, by = found.best, found.manipulated
        title, whose, left = f"{found.output.name} by {by.name}", best.name, best.residuals
        models = tuple((model.name, model.simulated) for model in found.models)
        signals = [
            ComparedSignal(found.output, record.values[found.output.name], models),
            ComparedSignal(by, record.values[by.name]),
        ]
        moving = [(by.name, record.values[by.name][held - len(left) : held])]
        said.append(Line(found.control_words))
        tests, rule = best.tests, RANKING_RULE
        origin = [(f"{model.name}, {model.title}", model.formula) for model in found.models]
    else:
        process, worst = found.process, found.worst or found.outputs[0]
        title, whose = f"{process.title}, parameters from a record", worst.signal.name
        signals = [
            ComparedSignal(output.signal, output.measured, (("simulated", output.simulated),))
            for output in found.outputs
        ]
        outside = [
            ComparedSignal(signal, record.values[signal.name])
            for signal in (*process.inputs, *process.disturbances)
            if signal in record.signals and np.ptp(record.values[signal.name]) > 0.0
        ]
        signals += outside
        left = worst.measured[:held] - worst.simulated[:held]
        moving = [(each.signal.name, each.measured[:held]) for each in outside]
        tests, rule, origin = worst.tests, _FIT_WORDS, [("process file", address_text(process))]
    facts = [
        ("record", record.place),
        ("rows", f"{record.samples}, one each {time_text(record.period, 4)}"),
        ("held back", f"from {time_text(float(record.time[held]), 4)} on"),
        *origin,
        ("versions", versions_text()),
    ]
    compared = comparison_figure(record.time, held, signals)
    correlations = correlations_figure(left, moving)
    left_over = (
        Line(f"The residuals of {whose} are {tests.words}."),
        Picture(
            svg_text(correlations, "Correlations of the residuals", "correlations"), _CORRELATED
        ),
        Line(_TESTS),
    )
    parts: tuple[Line | Table | Picture | Section, ...] = (
        *said,
        *_watched(found),
        Picture(svg_text(compared, "Measured and simulated", "comparison"), _COMPARED),
        Section("What was found", (*_what_was_found(found), Line(rule))),
        Section("What is left", left_over),
        Section("How this was computed", (facts_table("", facts),)),
    )
    return page_text(Section(f"{title} – identification", parts))


def identification_answer(found: Identification | ProcessFit, *, every: bool = False) -> Section:
    """Return what was found and what to do with it, in about 25 lines of 80 columns."""
    parts: list[Line | Table] = [Line(found.verdict, Mark.ANSWER)]
    following = "keep the parameters by --write."
    first: list[Line | Table] = []
    if isinstance(found, Identification):
        parts.append(Line(found.control_words))
        following = (
            "enter the settings with care."
            if found.gives_settings
            else f"record more and larger steps of {found.manipulated.name}, each until "
            f"{found.output.name} has answered."
        )
        first = [replace(_models(found), title="", kept=3)]
    elif not every:
        parameters, outputs = _parameters(found), _outputs(found)
        first = [
            replace(parameters, title="", rows=parameters.rows[:_FITTED]),
            Line(""),
            replace(outputs, title="", rows=outputs.rows[:_FITTED], kept=2),
        ]
    watched = _watched(found)
    if every:
        parts += [*_what_was_found(found), *watched]
    else:
        more = len(watched) - _WATCHED
        said = f"{more} more to watch, and every" if more > 0 else "Every"
        rest = Line(f"{said} parameter and remark: --all")
        parts += [Line(""), *first, *watched[:_WATCHED], rest]
    step = f"Next: see measured against simulated on the page; {following}"
    return Section("", (*parts, Line(""), Line(step, Mark.NEXT)))


def _watched(found: Identification | ProcessFit) -> tuple[Line, ...]:
    warnings = found.warnings if isinstance(found, Identification) else found.notes
    return marked(Mark.WATCH, (f"{words}." for words in warnings))


def _what_was_found(found: Identification | ProcessFit) -> list[Line | Table]:
    """Return every parameter with its interval, and all that is to be said of the residuals."""
    if isinstance(found, ProcessFit):
        words = [f"{each.signal.name}: residuals {each.tests.words}." for each in found.outputs]
        words += [f"{each}." for each in found.alike] + _widened(found.sure.widening)
        start = Table(
            "State at the first row",
            ("state", "fitted", "95 % interval", ""),
            tuple((each.signal.name, *estimate_cells(each)) for each in found.start),
        )
        return [_parameters(found), _outputs(found), start, *marked(Mark.POINT, words)]
    rows = tuple(
        (f"{model.name}, {estimate.signal.description}", *estimate_cells(estimate))
        for model in found.models
        for estimate in model.estimates
    )
    parameters = Table("Parameters", ("parameter", "value", "95 % interval", ""), rows)
    parts: list[Line | Table] = [_models(found), parameters]
    for model in found.models:
        parts.append(Line(f"{model.name}: residuals {model.tests.words}.", Mark.POINT))
        parts += marked(Mark.WATCH, (f"{model.name}: {each}." for each in model.cautions))
    refused = (f"{name} could not be fitted: {reason}." for name, reason in found.refused)
    widened = _widened(found.best.widening)
    return [*parts, *marked(Mark.REFUSED, refused), *marked(Mark.POINT, widened)]


def _models(found: Identification) -> Table:
    """Return the models by rank, with how well they fit and what is left."""
    rows = [
        (f"{rank}  {each.name}", *_fits(each), str(each.parameters), *_tests(each.tests))
        for rank, each in enumerate(found.models, 1)
    ]
    head = ("model", "held back", "fitted", "parameters", "white?", "free of input?")
    return Table("Models by fit", head, tuple(rows))


def _parameters(fit: ProcessFit) -> Table:
    """Return the parameters of a process: as the file has them, fitted, and the interval."""
    rows = []
    for estimate, before in zip(fit.estimates, fit.before, strict=True):
        old = number_text(Estimate(estimate.signal, before).shown[0])
        rows.append((estimate.signal.name, old, *estimate_cells(estimate)))
    head = ("parameter", "in the file", "fitted", "95 % interval", "")
    return Table("Parameters", head, tuple(rows))


def _outputs(fit: ProcessFit) -> Table:
    """Return how well each measurement is told."""
    rows = tuple((each.signal.name, *_fits(each), *_tests(each.tests)) for each in fit.outputs)
    head = ("measurement", "held back", "fitted", "white?", "free of input?")
    return Table("Fit of the measurements", head, rows)


def estimate_cells(estimate: Estimate) -> tuple[str, str, str]:
    """Return value, interval and unit of an estimate; the value in digits that the interval tells.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> estimate_cells(Estimate(Signal("gain", "m/V", display_unit="cm/V"), 0.041234, 0.04, 0.042))
    ('4.123', '4.000 – 4.200', 'cm/V')
    """
    value, low, high = estimate.shown
    unit = unit_text(estimate.signal.shown_unit)
    if math.isnan(low):
        return number_text(value), "", unit
    if estimate.signal.low == 0.0 and not estimate.is_told:
        return number_text(value), "not told", unit
    digits = 3
    width = high - low
    if math.isfinite(width) and width > 0.0 and value != 0.0:
        digits = min(max(3, 2 + math.ceil(math.log10(abs(value) / width))), 5)
    return number_text(value, digits), " – ".join(number_text(e, digits) for e in (low, high)), unit


def _fits(each: FittedModel | OutputFit) -> list[str]:
    """Return the fits to the held-back third and to the others."""
    return [_fit(each.validated), _fit(each.fit)]


def _fit(fit: float) -> str:
    if math.isnan(fit):
        return "stands still"
    if math.isinf(fit):
        return "ran away"
    return "below −100 %" if fit < -100.0 else f"{fit:.1f} %".replace("-", "−")


def _tests(tests: ResidualTests) -> tuple[str, ...]:
    """Return whether each test of residuals speaks, with its probability."""
    return tuple(
        f"{'yes' if well else 'no'}, p {'<0.001' if chance < 0.001 else f'{chance:.2g}'}"
        for well, chance in (
            (tests.white, tests.whiteness),
            (tests.independent, tests.independence),
        )
    )


def _widened(widening: float) -> list[str]:
    """Return what the colour of residuals did to the intervals."""
    words = (
        "The residuals are coloured: the intervals are those of such noise, up to "
        f"{widening:.1f} times as wide as if it were white."
    )
    return [words] if widening > 1.0 else []
