"""An identification as rows of text, for a terminal and for a page."""

from __future__ import annotations

import math

from clepsydra.base.section import Line, Mark, Table, marked
from clepsydra.identification.estimate import Estimate
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.identification.residual_tests import ResidualTests
from clepsydra.report.quantities import number_text, unit_text


def what_was_found(found: Identification | ProcessFit) -> tuple[Line | Table, ...]:
    """Return every parameter with its interval, and all that is to be said of the residuals.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> [part.title for part in what_was_found(found)[:2]]
    ['Models by fit', 'Parameters']
    """
    if isinstance(found, Identification):
        parts: list[Line | Table] = [models_grid(found), estimates_grid(found)]
        for model in found.models:
            parts.append(Line(f"{model.name}: residuals {model.tests.words}.", Mark.POINT))
            parts += marked(Mark.WATCH, (f"{model.name}: {each}." for each in model.cautions))
        refused = (f"{name} could not be fitted: {reason}." for name, reason in found.refused)
        widened = widening_words(found.best.widening)
        return (*parts, *marked(Mark.REFUSED, refused), *marked(Mark.POINT, widened))
    residuals = (f"{each.signal.name}: residuals {each.tests.words}." for each in found.outputs)
    words = (
        *residuals,
        *(f"{each}." for each in found.alike),
        *widening_words(found.sure.widening),
    )
    tables = parameters_grid(found), outputs_grid(found), start_grid(found)
    return (*tables, *marked(Mark.POINT, words))


def models_grid(found: Identification) -> Table:
    """Return the models by rank, with how well they fit and what is left.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> models_grid(found).rows[0][:2]
    ('1  FOPDT', '96.9 %')
    """
    rows = [
        (
            f"{rank}  {model.name}",
            fit_text(model.validated),
            fit_text(model.fit),
            str(model.parameters),
            probability_text(model.tests.whiteness),
            probability_text(model.tests.independence),
        )
        for rank, model in enumerate(found.models, 1)
    ]
    head = ("model", "held back", "fitted", "parameters", "white?", "free of input?")
    return Table("Models by fit", head, tuple(rows))


def estimates_grid(found: Identification) -> Table:
    """Return every parameter of every model with its 95 % interval.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> estimates_grid(found).rows[0][0]
    'FOPDT, static gain'
    """
    rows = [
        (f"{model.name}, {estimate.signal.description}", *estimate_cells(estimate))
        for model in found.models
        for estimate in model.estimates
    ]
    return Table("Parameters", ("parameter", "value", "95 % interval", ""), tuple(rows))


def parameters_grid(fit: ProcessFit) -> Table:
    """Return the parameters of a process: as the file has them, fitted, and the interval.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.process_fit import fit_process
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> fit = fit_process(run.process, record_of(run, {"level_1": 0.02}), ["outlet_1.area"])
    >>> parameters_grid(fit).rows[0][:3]
    ('outlet_1.area', '0.0710', '0.071025')
    """
    rows = []
    for estimate, before in zip(fit.estimates, fit.before, strict=True):
        old = number_text(Estimate(estimate.signal, before).shown[0])
        rows.append((estimate.signal.name, old, *estimate_cells(estimate)))
    head = ("parameter", "in the file", "fitted", "95 % interval", "")
    return Table("Parameters", head, tuple(rows))


def start_grid(fit: ProcessFit) -> Table:
    """Return the states at the first row as they were fitted.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.process_fit import fit_process
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> fit = fit_process(run.process, record_of(run, {"level_1": 0.02}), ["outlet_1.area"])
    >>> start_grid(fit).rows[0][0]
    'tank_1.level'
    """
    rows = [(estimate.signal.name, *estimate_cells(estimate)) for estimate in fit.start]
    return Table("State at the first row", ("state", "fitted", "95 % interval", ""), tuple(rows))


def outputs_grid(fit: ProcessFit) -> Table:
    """Return how well each measurement is told.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.process_fit import fit_process
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> fit = fit_process(run.process, record_of(run, {"level_1": 0.02}), ["outlet_1.area"])
    >>> outputs_grid(fit).rows[0][0]
    'level_1'
    """
    rows = [
        (
            output.signal.name,
            fit_text(output.validated),
            fit_text(output.fit),
            probability_text(output.tests.whiteness),
            probability_text(output.tests.independence),
        )
        for output in fit.outputs
    ]
    head = ("measurement", "held back", "fitted", "white?", "free of input?")
    return Table("Fit of the measurements", head, tuple(rows))


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


def fit_text(fit: float) -> str:
    """Return a fit in percent.

    Examples
    --------
    >>> fit_text(91.26), fit_text(-4000.0), fit_text(-math.inf)
    ('91.3 %', 'below −100 %', 'ran away')
    """
    if math.isnan(fit):
        return "stands still"
    if math.isinf(fit):
        return "ran away"
    return "below −100 %" if fit < -100.0 else f"{fit:.1f} %".replace("-", "−")


def probability_text(probability: float) -> str:
    """Return whether a test of the residuals speaks, with its probability.

    Examples
    --------
    >>> probability_text(0.431), probability_text(1e-7)
    ('yes, p 0.43', 'no, p <0.001')
    """
    words = "yes" if ResidualTests(probability, 1.0, None).white else "no"
    shown = "<0.001" if probability < 0.001 else f"{probability:.2g}"
    return f"{words}, p {shown}"


def widening_words(widening: float) -> list[str]:
    """Return what the colour of residuals did to the intervals; nothing where that is nothing.

    Examples
    --------
    >>> widening_words(1.0), widening_words(2.34)[0][:45]
    ([], 'The residuals are coloured: the intervals are')
    """
    if widening <= 1.0:
        return []
    return [
        "The residuals are coloured: the intervals are those of such noise, up to "
        f"{widening:.1f} times as wide as if it were white."
    ]
