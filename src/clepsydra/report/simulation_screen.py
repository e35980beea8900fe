"""A simulation on a terminal of 100 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Plan
from clepsydra.report.simulation_tables import (
    balances_grid,
    events_grid,
    simulation_sentence,
    trajectories_grid,
    trust_sentence,
)
from clepsydra.report.tables import grid_table, hanging

if TYPE_CHECKING:
    from rich.console import RenderableType

#: Events that are listed one by one.
_LISTED = 12


def simulation_screen(plan: Plan, run: Simulation) -> RenderableType:
    """Return what a simulation did and how sure it is, for Rich.

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
    >>> import io
    >>> from rich.console import Console
    >>> console = Console(width=100, record=True, file=io.StringIO())
    >>> console.print(simulation_screen(plan, plan.run()))
    >>> "tank_1.level" in console.export_text()
    True
    """
    from rich.console import Group
    from rich.text import Text

    process = plan.process
    parts: list[RenderableType] = [
        Text(f"{process.title} ({process.name})"),
        Text(simulation_sentence(plan, run), style="bold"),
        Text(trust_sentence(run) + "\n"),
        grid_table(trajectories_grid(run)),
    ]
    if run.happenings:
        parts.append(grid_table(events_grid(run, _LISTED)))
    if run.balances:
        parts.append(grid_table(balances_grid(run)))
    parts += [hanging(f"!  {warning}", "yellow") for warning in plan.point.warnings]
    if not plan.changes and plan.begins == "at rest":
        parts.append(Text("Nothing moves: give an input, for example " + _example(plan)))
    parts.append(Text("\nNext: open the report and look at the trends."))
    return Group(*parts)


def _example(plan: Plan) -> str:
    for signal in (*plan.process.inputs, *plan.process.disturbances):
        return f"--input '{signal.name}=VALUE@TIME' (in {signal.shown_unit})."
    return "a state, as in --state NAME=VALUE."
