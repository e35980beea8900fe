"""An identification on a terminal of 100 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from clepsydra.report.tables import grid_table, hanging

if TYPE_CHECKING:
    from rich.console import RenderableType


def identification_screen(found: Identification | ProcessFit) -> RenderableType:
    """Return what was found and what to do with it, for Rich.

    Parameters
    ----------
    found : Identification or ProcessFit

    Examples
    --------
    >>> import clepsydra as cl
    >>> import io
    >>> from rich.console import Console
    >>> from clepsydra.identification.identification import identify_model
    >>> from clepsydra.identification.simulated_record import record_of
    >>> step = [cl.step("pump_1", "+0.5 V", at="20 s")]
    >>> run = cl.simulate(cl.load("quadruple-tank"), None, step, duration="2 min")
    >>> found = identify_model(record_of(run, {"level_1": 0.02}), "pump_1", "level_1")
    >>> console = Console(width=100, record=True, file=io.StringIO())
    >>> console.print(identification_screen(found))
    >>> "held back" in console.export_text()
    True
    """
    from rich.console import Group
    from rich.text import Text

    if isinstance(found, Identification):
        parts: list[RenderableType] = [
            Text(found.verdict, style="bold"),
            Text(found.control_words + "\n"),
            grid_table(models_grid(found)),
            grid_table(estimates_grid(found)),
        ]
        for model in found.models:
            parts.append(hanging(f"•  {model.name}: residuals {model.tests.words}."))
            parts += [hanging(f"!  {model.name}: {remark}.", "yellow") for remark in model.cautions]
        parts += [
            hanging(f"–  {name} could not be fitted: {reason}.") for name, reason in found.refused
        ]
        warnings, widening = found.warnings, widening_words(found.best.widening)
        following = "see measured against simulated on the page; enter the settings with care."
    else:
        parts = [
            Text(found.verdict + "\n", style="bold"),
            grid_table(parameters_grid(found)),
            grid_table(outputs_grid(found)),
            grid_table(start_grid(found)),
        ]
        for output in found.outputs:
            parts.append(hanging(f"•  {output.signal.name}: residuals {output.tests.words}."))
        parts += [hanging(f"•  {words}.") for words in found.alike]
        warnings, widening = found.notes, widening_words(found.sure.widening)
        following = "see measured against simulated on the page; keep the parameters by --write."
    if widening:
        parts.append(hanging(f"•  {widening}"))
    parts += [hanging(f"!  {warning}.", "yellow") for warning in warnings]
    parts.append(Text(f"\nNext: {following}"))
    return Group(*parts)
