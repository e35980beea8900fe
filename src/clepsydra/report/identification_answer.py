"""An identification in a screen."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.report.identification_tables import (
    estimates_grid,
    models_grid,
    outputs_grid,
    parameters_grid,
    start_grid,
    widening_words,
)


def identification_answer(found: Identification | ProcessFit) -> Section:
    """Return what was found and what to do with it.

    Parameters
    ----------
    found : Identification or ProcessFit

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> identification_answer(found).parts[0].text == found.verdict
    True
    """
    if isinstance(found, Identification):
        parts: list[Line | Table | Section] = [
            Line(found.verdict, Mark.ANSWER),
            Line(found.control_words),
            models_grid(found),
            estimates_grid(found),
        ]
        for model in found.models:
            parts.append(Line(f"{model.name}: residuals {model.tests.words}.", Mark.POINT))
            parts += marked(Mark.WATCH, (f"{model.name}: {each}." for each in model.cautions))
        refused = (f"{name} could not be fitted: {reason}." for name, reason in found.refused)
        parts += marked(Mark.REFUSED, refused)
        warnings, widening = found.warnings, widening_words(found.best.widening)
        following = "see measured against simulated on the page; enter the settings with care."
    else:
        parts = [
            Line(found.verdict, Mark.ANSWER),
            parameters_grid(found),
            outputs_grid(found),
            start_grid(found),
        ]
        residuals = (f"{y.signal.name}: residuals {y.tests.words}." for y in found.outputs)
        parts += marked(Mark.POINT, (*residuals, *(f"{words}." for words in found.alike)))
        warnings, widening = found.notes, widening_words(found.sure.widening)
        following = "see measured against simulated on the page; keep the parameters by --write."
    parts += [Line(widening, Mark.POINT)] if widening else []
    parts += marked(Mark.WATCH, (f"{warning}." for warning in warnings))
    return Section("", (*parts, Line(""), Line(f"Next: {following}")))
