"""The report of an open-loop simulation: one HTML file, without a network or a script."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.files import whole_file
from clepsydra.base.section import Table
from clepsydra.base.words import time_text
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Plan
from clepsydra.report.colours import signal_colours
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.html import address_text, versions_text
from clepsydra.report.panels import all_panels
from clepsydra.report.simulation_tables import (
    balances_grid,
    change_words,
    events_grid,
    simulation_sentence,
    trajectories_grid,
    trust_sentence,
)
from clepsydra.report.svg import svg_text
from clepsydra.report.template import rendered
from clepsydra.report.trends import trend_figure

#: Events and changes that the page lists one by one.
_LISTED = 40


def write_simulation_page(plan: Plan, run: Simulation, path: str | Path) -> None:
    """Write the report of a simulation; an existing file is replaced only by a whole one.

    Parameters
    ----------
    plan : Plan
    run : Simulation
        Of that plan.
    path : str or Path
        An HTML file. Two reports of one simulation are equal byte for byte.

    Raises
    ------
    InputError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.loop.open_loop_plan import plan_simulation
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("equalisation-tank"), duration="1 h")
    >>> run = plan.run()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_simulation_page(plan, run, Path(folder, "page.html"))
    ...     simulation_sentence(plan, run) in Path(folder, "page.html").read_text("utf-8")
    True
    """
    text = simulation_text(plan, run)
    with whole_file(Path(path)) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def simulation_text(plan: Plan, run: Simulation) -> str:
    """Return the report of a simulation as HTML.

    Examples
    --------
    See `write_simulation_page`.
    """
    from markupsafe import Markup

    process = plan.process
    figure = trend_figure(run, all_panels(run))
    title = f"States, manipulated variables and disturbances of {process.title}"
    return rendered(
        "simulation.html.jinja",
        process=process,
        sentence=simulation_sentence(plan, run),
        trust=trust_sentence(run),
        picture=Markup(svg_text(figure, title, "trends")),
        drawing=Markup(process_drawing(process, plan.first)),
        events=events_grid(run, _LISTED),
        trajectories=trajectories_grid(run),
        balances=balances_grid(run),
        changes=_changes_grid(plan),
        begins=plan.begins,
        warnings=plan.point.warnings,
        computation=_computation(plan, run),
        colours=signal_colours(process),
    )


def _changes_grid(plan: Plan) -> Table:
    changes = sorted(plan.changes, key=lambda change: (change.start, change.signal))
    rows = [(change_words(plan.process, change),) for change in changes[:_LISTED]]
    if len(changes) > _LISTED:
        rows.append((f"and {len(changes) - _LISTED} more",))
    return Table("What was done", ("change",), tuple(rows))


def _computation(plan: Plan, run: Simulation) -> list[tuple[str, str]]:
    """Return how the numbers came about, as (what, how)."""
    process = plan.process
    solver = "reference solver, relative tolerance 1e−10"
    if run.substeps:
        solver = f"Runge-Kutta of order 4, steps in a sample: {run.substeps}"
    error = "kept to the tolerance of the solver, not estimated"
    if run.error_estimate is not None:
        error = f"{run.error_estimate:.1e} of the state's range, by step halving"
    return [
        ("process file", address_text(process)),
        ("source of the numbers", process.source),
        ("start", plan.begins),
        ("sampling period", time_text(process.sampling_period, 4)),
        ("samples", str(plan.samples)),
        ("integration", solver),
        ("error", error),
        ("versions", versions_text()),
    ]
