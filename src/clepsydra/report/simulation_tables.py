"""A simulation in words and rows of text, for a terminal and for a page."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.base.words import listed, time_text
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import TOLERANCE, Plan
from clepsydra.loop.profile import Change
from clepsydra.process.process import Process
from clepsydra.report.event_marks import event_marks
from clepsydra.report.quantities import number_text, quantity_text, short_text, unit_text

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
    return (
        f"Starts {plan.begins} and runs for {time_text(plan.duration, 4)} {_changes_text(plan)}; "
        f"{events}."
    )


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
        elif run.error_estimate > TOLERANCE:
            sure += f", more than the {number_text(100.0 * TOLERANCE)} % that was aimed at"
    closed = max((balance.error for balance in run.balances), default=0.0)
    if not run.balances:
        return f"{sure}."
    names = " and ".join(balance.name for balance in run.balances)
    return f"{sure}; the balance of {names} closes to {number_text(closed, 2)} of the throughput."


def change_words(process: Process, change: Change) -> str:
    """Return what a change does.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> change_words(process, Change("pump_1", 4.0, 60.0, 120.0))
    'pump_1 to 4 V from 60 s to 120 s'
    """
    signal = process.signal(change.signal)
    shown = from_si(change.value, signal.unit, signal.shown_unit)
    words = f"{change.signal} to {short_text(shown)} {unit_text(signal.shown_unit)}".strip()
    if change.is_ramp:
        return f"{words} from {time_text(change.start, 4)} to {time_text(change.stop, 4)}"
    return f"{words} at {time_text(change.start, 4)}" if change.start else f"{words} from the start"


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
    """Return the signals of a simulation that a reader is told about.

    Examples
    --------
    >>> import clepsydra as cl
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> [signal.name for signal in shown_signals(run)][-2:]
    ['pump_1', 'pump_2']
    """
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
    rows = tuple(
        (
            balance.name,
            *(
                f"{number_text(amount)} {unit_text(balance.unit)}".strip()
                for amount in (balance.entered, balance.left, balance.gained)
            ),
            number_text(balance.error, 2),
        )
        for balance in run.balances
    )
    return Table("Balance", ("", "entered", "left", "gained", "error"), rows)


def _changes_text(plan: Plan) -> str:
    changes = sorted(plan.changes, key=lambda change: change.start)
    if not changes:
        return "without any change"
    if len(changes) > _NAMED_CHANGES:
        names = list(dict.fromkeys(change.signal for change in changes))
        return f"with {len(changes)} changes of {listed(names)}"
    return f"with {listed([change_words(plan.process, change) for change in changes])}"
