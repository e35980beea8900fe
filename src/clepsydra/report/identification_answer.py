"""An identification in a screen."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.report.identification_tables import (
    models_grid,
    outputs_grid,
    parameters_grid,
    what_was_found,
)

#: Of the answer: parameters of a process, and warnings.
_FITTED, _WATCHED = 6, 2
_EMPTY = Line("")


def identification_answer(found: Identification | ProcessFit, *, every: bool = False) -> Section:
    """Return what was found and what to do with it, in about 25 lines of 80 columns.

    Parameters
    ----------
    found : Identification or ProcessFit
    every : bool
        Whether with every parameter, its interval, and all that is to be said of the residuals.

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
    of_model = isinstance(found, Identification)
    parts = [Line(found.verdict, Mark.ANSWER)]
    parts += [Line(found.control_words)] if isinstance(found, Identification) else []
    warnings = found.warnings if isinstance(found, Identification) else found.notes
    following = "enter the settings with care." if of_model else "keep the parameters by --write."
    watched = marked(Mark.WATCH, (f"{warning}." for warning in warnings))
    shown: tuple[Line | Table, ...] = (*what_was_found(found), *watched)
    if not every:
        more = len(watched) - _WATCHED
        said = f"{more} more to watch, and every" if more > 0 else "Every"
        rest = Line(f"{said} parameter and remark: --all")
        shown = (_EMPTY, *_tables(found), *watched[:_WATCHED], rest)
    next_step = Line(f"Next: see measured against simulated on the page; {following}")
    return Section("", (*parts, *shown, _EMPTY, next_step))


def _tables(found: Identification | ProcessFit) -> tuple[Table | Line, ...]:
    """Return the tables that an answer begins with."""
    if isinstance(found, Identification):
        return (replace(models_grid(found), title="", kept=3),)
    parameters, outputs = parameters_grid(found), outputs_grid(found)
    few = replace(parameters, title="", rows=parameters.rows[:_FITTED])
    return few, _EMPTY, replace(outputs, title="", rows=outputs.rows[:_FITTED], kept=2)
