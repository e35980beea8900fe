"""What a simulation without a controller did: its answer, its tables, and its page."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import listed, time_text
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import TOLERANCE, Plan
from clepsydra.loop.profile import Change
from clepsydra.process.process import Process
from clepsydra.report.alarm_tables import alarm_words, alarms_of_run
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.facts import facts_table
from clepsydra.report.html import address_text, integration_words, versions_text
from clepsydra.report.page import page_text, svg_text
from clepsydra.report.quantities import (
    number_text,
    quantity_text,
    short_text,
)
from clepsydra.report.recording import event_marks
from clepsydra.report.trends import plot

#: Events and changes that the page lists one by one.
_ON_PAGE = 40
_LEGEND = (
    "Each signal in its unit and in percent: of the range of its sensor, or of its own. Hatched: "
    "beyond a limit; a black bar on the time axis: at a limit; vertical lines: events, numbered as "
    "in the list; one that happens often has one line, with its count."
)
_BALANCED = (
    "Entered and left: through the boundary of the plant. Gained: more in its tanks and delays "
    "than at first. Error: what does not close, as a share of the largest of the three."
)


def simulation_text(plan: Plan, run: Simulation) -> str:
    """Return the report of a simulation as HTML."""
    process = plan.process
    words = f"States, manipulated variables and disturbances of {process.title}"
    events, balances = events_grid(run, _ON_PAGE), balances_grid(run)
    happened = (
        _changes_grid(plan),
        trajectories_grid(run),
        events if events.rows else Line("No event happened."),
        *alarms_of_run(run),
        *((balances, Line(_BALANCED)) if balances.rows else ()),
    )
    begins = Line(f"The values are those with which it begins: {plan.begins}.")
    facts = [
        ("process file", address_text(process)),
        ("source of the numbers", process.source),
        ("start", plan.begins),
        ("sampling period", time_text(process.sampling_period, 4)),
        ("samples", str(plan.samples)),
        ("integration", integration_words(run.substeps, [run.error_estimate])),
        ("versions", versions_text()),
    ]
    drawing = Picture(process_drawing(process, plan.first))
    parts: tuple[Line | Picture | Section, ...] = (
        Line(simulation_sentence(plan, run), Mark.ANSWER),
        Line(trust_sentence(run)),
        *marked(Mark.WATCH, plan.point.warnings),
        Picture(svg_text(plot(run), words, "trends"), _LEGEND),
        Section("What happened", happened),
        Section("The process at the start", (drawing, begins)),
        Section("How this was computed", (facts_table("", facts),)),
    )
    return page_text(Section(f"{process.title} – simulation without a controller", parts))


def _changes_grid(plan: Plan) -> Table | Line:
    changes = sorted(plan.changes, key=lambda change: (change.start, change.signal))
    if not changes:
        return Line("No signal was given a change: each stayed at its value at the start.")
    rows = [(change_words(plan.process, change),) for change in changes[:_ON_PAGE]]
    if len(changes) > _ON_PAGE:
        rows.append((f"and {len(changes) - _ON_PAGE} more",))
    return Table("What was done", ("change",), tuple(rows))


#: Of the answer: signals, events and warnings; and events of the whole.
_SIGNALS, _EVENTS, _WATCHED, _LISTED = 6, 3, 2, 12


def simulation_answer(plan: Plan, run: Simulation, *, every: bool = False) -> Section:
    """Return what a simulation did and how sure it is, in about 25 lines of 80 columns.

    Parameters
    ----------
    run : Simulation
        Of that plan.
    every : bool
        Whether with every signal and balance, and when it was smallest and largest.
    """
    process, warnings = plan.process, plan.point.warnings
    parts: list[Line | Table] = [Line(simulation_sentence(plan, run), Mark.ANSWER)]
    if every:
        tables = trajectories_grid(run), events_grid(run, _LISTED), balances_grid(run)
        parts += [table for table in tables if table.rows]
        parts += alarms_of_run(run)
        parts += [Line(trust_sentence(run)), *marked(Mark.WATCH, warnings)]
    else:
        shown = shown_signals(run)
        moving = [signal for signal in shown if not is_still(run.values[signal.name])][:_SIGNALS]
        rows = tuple((signal.name, *trajectory_cells(run, signal)) for signal in moving)
        moved = Table("", ("what moved", "start", "end", "smallest", "largest"), rows)
        for table in (moved, replace(events_grid(run, _EVENTS), title="", names=3)):
            parts += [Line(""), table] if table.rows else []
        parts += [Line(words)] if (words := alarm_words(run)) else []
        parts += [Line(trust_sentence(run)), *marked(Mark.WATCH, warnings[:_WATCHED])]
        still = len(shown) - len(rows)
        more = f"{still} more signal{'s' if still > 1 else ''}, times" if still else "Times"
        parts.append(Line(f"{more} and balances: --all"))
    unmoved = not plan.changes and plan.begins == "at rest"
    following = _example(plan) if unmoved else "Next: open the report and look at the trends."
    parts += [Line(""), Line(following, Mark.NEXT)]
    return Section(f"{process.title} ({process.name})", tuple(parts))


def _example(plan: Plan) -> str:
    """Return how something would move: a signal a tenth of its range away from where it rests."""
    for signal in (*plan.process.inputs, *plan.process.disturbances):
        if signal.has_range:
            rest = plan.point.as_dict()[signal.name]
            way = 0.1 if signal.high - rest > rest - signal.low else -0.1
            value = from_si(rest + way * signal.span, signal.unit, signal.shown_unit)
            change = f"--input '{signal.name}={value:.3g} {signal.shown_unit}@10 s'"
            return f"Next: let something move, for example with {change}"
    return "Next: let something move, as with --state NAME=VALUE"


#: Changes that one sentence still names.
_NAMED_CHANGES = 3
#: A signal that moves by less than this share of its size does not move: that is rounding.
_STILL = 1e-9


def simulation_sentence(plan: Plan, run: Simulation) -> str:
    """Return what was done and what happened, in one sentence.

    Examples
    --------
    >>> from clepsydra.loop.open_loop_plan import plan_simulation
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("quadruple-tank"), duration="60 s")
    >>> simulation_sentence(plan, plan.run())
    'Starts at rest and runs for 60 s without any change; no events.'
    """
    count = sum(event.times for event in run.events)
    events = "1 event" if count == 1 else f"{count or 'no'} events"
    if run.end is not None:
        events += f"; it ended at {time_text(run.end.time, 4)}: {run.end.words.partition(':')[0]}"
    runs = f"Starts {plan.begins} and runs for {time_text(plan.duration, 4)}"
    return f"{runs} {_changes_text(plan)}; {events}."


def trust_sentence(run: Simulation) -> str:
    """Return how sure a simulation is: its error and its balances.

    Examples
    --------
    >>> import clepsydra as cl
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s", solver="reference")
    >>> trust_sentence(run)[:34]
    'Integrated by the reference solver'
    """
    sure = "Integrated by the reference solver to a relative tolerance of 1e−10"
    if run.error_estimate is not None:
        error = number_text(100.0 * run.error_estimate, 2)
        sure = f"Step halving estimates the largest error of a state at {error} % of its range"
        if math.isnan(run.error_estimate):
            sure = "The simulation broke down: a state became not a number"
        elif run.error_estimate >= 1.0:
            sure = (
                "Halving the integration step moves a state by as much as its whole range: no "
                "figure of this run can be relied on, so compare with the reference solver"
            )
        elif run.error_estimate > TOLERANCE:
            sure += f", more than the {number_text(100.0 * TOLERANCE)} % that was aimed at"
    if not run.balances:
        return f"{sure}."
    closed = max(balance.error for balance in run.balances)
    names = " and ".join(balance.name for balance in run.balances)
    return f"{sure}; the balance of {names} closes to {number_text(closed, 2)} of the throughput."


def change_words(process: Process, change: Change) -> str:
    """Return what a change does.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> change_words(process, Change("pump_1", 4.0, 60.0, 60.0, back=65.0))
    'pump_1 to 4 V at 60 s for 5 s'
    >>> change_words(process, Change("pump_1", 4.0, 60.0, 120.0))
    'pump_1 to 4 V from 60 s to 120 s'
    """
    signal = process.signal(change.signal)
    shown = from_si(change.value, signal.unit, signal.shown_unit)
    words = f"{change.signal} to {short_text(shown)} {unit_text(signal.shown_unit)}".strip()
    if change.is_ramp:
        return f"{words} from {time_text(change.start, 4)} to {time_text(change.stop, 4)}"
    began = (
        f"{words} at {time_text(change.start, 4)}" if change.start else f"{words} from the start"
    )
    return (
        began if change.back is None else f"{began} for {time_text(change.back - change.start, 4)}"
    )


def trajectories_grid(run: Simulation) -> Table:
    """Return the first, last, smallest and largest value of each state, measurement and input.

    Of the disturbances and of the volumes spilt there are those that are not always the same.

    Examples
    --------
    >>> import clepsydra as cl
    >>> trajectories_grid(cl.simulate(cl.load("quadruple-tank"), start="empty")).rows[0][:2]
    ('tank_1.level', '0 cm')
    """
    rows = []
    for signal in shown_signals(run):
        start, end, *extremes = trajectory_cells(run, signal, 4)
        values = run.values[signal.name]
        times = [time_text(float(run.time[k]), 4) for k in (np.argmin(values), np.argmax(values))]
        timed = [f"{cell} at {time}" for cell, time in zip(extremes, times, strict=True)]
        rows.append((signal.name, start, end, *(["–", "–"] if is_still(values) else timed)))
    return Table("Trajectories", ("", "start", "end", "smallest", "largest"), tuple(rows))


def trajectory_cells(run: Simulation, signal: Signal, digits: int = 3) -> list[str]:
    """Return the first, last, smallest and largest value of a signal.

    Examples
    --------
    >>> import clepsydra as cl
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> trajectory_cells(run, run.process.signal("pump_1"))
    ['3.00 V', '3.00 V', '3.00 V', '3.00 V']
    """
    values = run.values[signal.name]
    numbers = (values[0], values[-1], values.min(), values.max())
    return [quantity_text(signal, float(number), digits) for number in numbers]


def is_still(values: np.ndarray) -> bool:
    """Return whether a signal does not move, but for rounding.

    Examples
    --------
    >>> is_still(np.array([0.12, 0.12])), is_still(np.array([0.12, 0.121]))
    (True, False)
    """
    return bool(np.ptp(values) <= _STILL * np.max(np.abs(values)))


def shown_signals(run: Simulation) -> list[Signal]:
    """Return the signals of a simulation that a reader is told about."""
    process = run.process
    moving = [
        signal
        for signal in (*process.disturbances, *process.motion.totals)
        if signal.name in run.values and np.ptp(run.values[signal.name]) > 0.0
    ]
    return [*process.state, *process.measurements, *process.inputs, *moving]


def events_grid(run: Simulation, most: int) -> Table:
    """Return the events in order of time, the first `most` of them, numbered as in the picture.

    What happens often is one line, with how often and the last time.

    Examples
    --------
    >>> import clepsydra as cl
    >>> events_grid(cl.simulate(cl.load("quadruple-tank"), duration="60 s"), most=5).rows
    ()
    """
    marks = event_marks(run.events)
    rows = [
        (str(number), time_text(mark.time, 4), mark.sentence)
        for number, mark in enumerate(marks[:most], 1)
    ]
    if len(marks) > most:
        last = time_text(run.events[-1].time, 4)
        rows.append(("…", "", f"and {len(marks) - most} more, the last at {last}"))
    return Table("Events", ("", "time", "what happened"), tuple(rows))


def balances_grid(run: Simulation) -> Table:
    """Return what entered, left and stayed of the liquid and of each component.

    Examples
    --------
    >>> import clepsydra as cl
    >>> balances_grid(cl.simulate(cl.load("quadruple-tank"), duration="60 s")).rows[0][:2]
    ('liquid', '0.00120 m³')
    """
    rows = []
    for each in run.balances:
        amounts = map(number_text, (each.entered, each.left, each.gained))
        cells = (f"{amount} {unit_text(each.unit)}".strip() for amount in amounts)
        rows.append((each.name, *cells, number_text(each.error, 2)))
    return Table("Balance", ("", "entered", "left", "gained", "error"), tuple(rows))


def _changes_text(plan: Plan) -> str:
    changes = sorted(plan.changes, key=lambda change: change.start)
    if not changes:
        return "without any change"
    if len(changes) > _NAMED_CHANGES:
        names = list(dict.fromkeys(change.signal for change in changes))
        return f"with {len(changes)} changes of {listed(names)}"
    return f"with {listed([change_words(plan.process, change) for change in changes])}"
