"""The report of an open-loop simulation: one HTML file, without a network or a script."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.words import time_text
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Plan
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.facts import facts_table
from clepsydra.report.html import address_text, integration_words, versions_text
from clepsydra.report.page import page_text, write_page
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
from clepsydra.report.trends import trend_figure

#: Events and changes that the page lists one by one.
_LISTED = 40
_LEGEND = (
    "Each signal in its unit and in percent: of the range of its sensor, or of its own. Hatched: "
    "beyond a limit; a black bar on the time axis: at a limit; vertical lines: events, numbered as "
    "in the list; one that happens often has one line, with its count."
)
_BALANCED = (
    "Entered and left: through the boundary of the plant. Gained: more in its tanks and delays "
    "than at first. Error: what does not close, as a share of the largest of the three."
)


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
    write_page(simulation_text(plan, run), path)


def simulation_text(plan: Plan, run: Simulation) -> str:
    """Return the report of a simulation as HTML.

    Examples
    --------
    See `write_simulation_page`.
    """
    process = plan.process
    figure = trend_figure(run, all_panels(run))
    words = f"States, manipulated variables and disturbances of {process.title}"
    return page_text(
        Section(
            f"{process.title} – simulation without a controller",
            (
                Line(simulation_sentence(plan, run), Mark.ANSWER),
                Line(trust_sentence(run)),
                *marked(Mark.WATCH, plan.point.warnings),
                Picture(svg_text(figure, words, "trends"), _LEGEND),
                Section("What happened", _what_happened(plan, run)),
                Section(
                    "The process at the start",
                    (
                        Picture(process_drawing(process, plan.first)),
                        Line(f"The values are those with which it begins: {plan.begins}."),
                    ),
                ),
                Section("How this was computed", (facts_table("", _computation(plan, run)),)),
            ),
        )
    )


def _what_happened(plan: Plan, run: Simulation) -> tuple[Line | Table, ...]:
    changes, events, balances = _changes_grid(plan), events_grid(run, _LISTED), balances_grid(run)
    return (
        changes
        if changes.rows
        else Line("No signal was given a change: each stayed at its value at the start."),
        trajectories_grid(run),
        events if events.rows else Line("No event happened."),
        *((balances, Line(_BALANCED)) if balances.rows else ()),
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
    return [
        ("process file", address_text(process)),
        ("source of the numbers", process.source),
        ("start", plan.begins),
        ("sampling period", time_text(process.sampling_period, 4)),
        ("samples", str(plan.samples)),
        ("integration", integration_words(run.substeps, [run.error_estimate])),
        ("versions", versions_text()),
    ]
