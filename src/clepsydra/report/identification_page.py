"""The page of an identification: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clepsydra.base.files import whole_file
from clepsydra.base.words import time_text
from clepsydra.identification.identification import Identification
from clepsydra.identification.process_fit import ProcessFit
from clepsydra.identification.ranking import RANKING_RULE
from clepsydra.identification.record import Record
from clepsydra.report.html import address_text, versions_text
from clepsydra.report.identification_picture import (
    ComparedSignal,
    comparison_svg,
    correlations_svg,
)
from clepsydra.report.identification_tables import (
    estimates_grid,
    models_grid,
    outputs_grid,
    parameters_grid,
    start_grid,
    widening_words,
)
from clepsydra.report.template import rendered

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
    with whole_file(Path(path)) as part:
        part.write_text(identification_text(found), encoding="utf-8", newline="\n")


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
    rows = len(best.residuals)
    earlier = moved[record.held_back - rows : record.held_back]
    notes = [f"{model.name}: {remark}." for model in found.models for remark in model.cautions]
    notes += [f"{name} could not be fitted: {reason}." for name, reason in found.refused]
    formulas = [(f"{m.name}, {m.title}", m.formula) for m in found.models]
    return _page(
        record,
        title=f"{found.output.name} by {found.manipulated.name}",
        verdict=found.verdict,
        control=found.control_words,
        warnings=found.warnings,
        picture=comparison_svg(
            record.time, record.held_back, signals, "Measured and simulated", "comparison"
        ),
        residuals=f"The residuals of {best.name} are {best.tests.words}.",
        correlations=correlations_svg(
            best.residuals, [(found.manipulated.name, earlier)], "correlations"
        ),
        grids=[models_grid(found), estimates_grid(found)],
        notes=[*notes, *filter(None, [widening_words(best.widening)])],
        rule=RANKING_RULE,
        computation=[*formulas, ("versions", versions_text())],
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
    worst = fit.worst or fit.outputs[0]
    count = record.held_back
    left = worst.measured[:count] - worst.simulated[:count]
    return _page(
        record,
        title=f"{process.title}, parameters from a record",
        verdict=fit.verdict,
        control="",
        warnings=fit.notes,
        picture=comparison_svg(
            record.time, count, signals, "Measured and simulated", "comparison"
        ),
        residuals=f"The residuals of {worst.signal.name} are {worst.tests.words}.",
        correlations=correlations_svg(
            left, [(signal.name, values[:count]) for signal, values in moving], "correlations"
        ),
        grids=[parameters_grid(fit), outputs_grid(fit), start_grid(fit)],
        notes=[*(f"{words}." for words in fit.alike),
               *filter(None, [widening_words(fit.sure.widening)])],
        rule=_FIT_WORDS,
        computation=[
            ("process file", address_text(process)),
            ("versions", versions_text()),
        ],
    )  # fmt: skip


def _page(record: Record, *, picture: str, correlations: str, **content: object) -> str:
    from markupsafe import Markup

    facts = [
        ("record", record.place),
        ("rows", f"{record.samples}, one each {time_text(record.period, 4)}"),
        ("held back", f"from {time_text(float(record.time[record.held_back]), 4)} on"),
    ]
    return rendered(
        "identification.html.jinja",
        facts=facts,
        picture=Markup(picture),
        correlations=Markup(correlations),
        colours={},
        **content,
    )
