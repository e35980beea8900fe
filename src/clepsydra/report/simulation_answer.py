"""A simulation on a screen."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Plan
from clepsydra.report.simulation_tables import (
    balances_grid,
    events_grid,
    simulation_sentence,
    trajectories_grid,
    trust_sentence,
)

#: Events that are listed one by one.
_LISTED = 12


def simulation_answer(plan: Plan, run: Simulation) -> Section:
    """Return what a simulation did and how sure it is.

    Parameters
    ----------
    plan : Plan
    run : Simulation
        Of that plan.

    Examples
    --------
    >>> from clepsydra.loop.open_loop_plan import plan_simulation
    >>> from clepsydra.process.reader import load_process
    >>> plan = plan_simulation(load_process("quadruple-tank"), duration="60 s")
    >>> simulation_answer(plan, plan.run()).parts[2].rows[0][0]
    'tank_1.level'
    """
    process = plan.process
    parts: list[Line | Table | Section] = [
        Line(simulation_sentence(plan, run), Mark.ANSWER),
        Line(trust_sentence(run)),
        trajectories_grid(run),
    ]
    parts += [events_grid(run, _LISTED)] if run.events else []
    parts += [balances_grid(run)] if run.balances else []
    parts += marked(Mark.WATCH, plan.point.warnings)
    if not plan.changes and plan.begins == "at rest":
        parts.append(Line("Nothing moves: give an input, for example " + _example(plan)))
    parts += [Line(""), Line("Next: open the report and look at the trends.")]
    return Section(f"{process.title} ({process.name})", tuple(parts))


def _example(plan: Plan) -> str:
    for signal in (*plan.process.inputs, *plan.process.disturbances):
        return f"--input '{signal.name}=VALUE@TIME' (in {signal.shown_unit})."
    return "a state, as in --state NAME=VALUE."
