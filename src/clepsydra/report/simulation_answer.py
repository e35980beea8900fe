"""A simulation on a screen."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.units import from_si
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Plan
from clepsydra.report.simulation_tables import (
    balances_grid,
    events_grid,
    is_still,
    shown_signals,
    simulation_sentence,
    trajectories_grid,
    trajectory_cells,
    trust_sentence,
)

#: Of the answer: signals, events and warnings; and events of the whole.
_SIGNALS, _EVENTS, _WATCHED, _LISTED = 6, 3, 2, 12
_EMPTY = Line("")


def simulation_answer(plan: Plan, run: Simulation, *, every: bool = False) -> Section:
    """Return what a simulation did and how sure it is, in about 25 lines of 80 columns.

    Parameters
    ----------
    plan : Plan
    run : Simulation
        Of that plan.
    every : bool
        Whether with every signal and balance, and when it was smallest and largest.

    Examples
    --------
    >>> from clepsydra.loop.open_loop_plan import plan_simulation
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("quadruple-tank"), duration="60 s", start="empty")
    >>> simulation_answer(plan, plan.run()).parts[2].head
    ('what moved', 'start', 'end', 'smallest', 'largest')
    """
    process = plan.process
    parts: list[Line | Table | Section] = [Line(simulation_sentence(plan, run), Mark.ANSWER)]
    warnings = plan.point.warnings
    if every:
        parts += [trajectories_grid(run)]
        parts += [events_grid(run, _LISTED)] if run.events else []
        parts += [balances_grid(run)] if run.balances else []
        parts += [Line(trust_sentence(run)), *marked(Mark.WATCH, warnings)]
    else:
        moved, still = _moved(run)
        parts += [_EMPTY, moved] if moved.rows else []
        if run.events:
            parts += [_EMPTY, replace(events_grid(run, _EVENTS), title="", names=3)]
        parts += [Line(trust_sentence(run)), *marked(Mark.WATCH, warnings[:_WATCHED])]
        more = f"{still} more signals, times" if still else "Times"
        parts.append(Line(f"{more} and balances: --all"))
    unmoved = not plan.changes and plan.begins == "at rest"
    following = _example(plan) if unmoved else "Next: open the report and look at the trends."
    parts += [_EMPTY, Line(following)]
    return Section(f"{process.title} ({process.name})", tuple(parts))


def _moved(run: Simulation) -> tuple[Table, int]:
    """Return the range of what moved, and how many signals are left out."""
    shown = shown_signals(run)
    moving = [signal for signal in shown if not is_still(run.values[signal.name])][:_SIGNALS]
    rows = tuple((signal.name, *trajectory_cells(run, signal)) for signal in moving)
    head = ("what moved", "start", "end", "smallest", "largest")
    return Table("", head, rows), len(shown) - len(rows)


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
