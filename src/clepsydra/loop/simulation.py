"""An open-loop run from words: one call from the name of a process to its trajectories."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clepsydra.base.arguments import require_type
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.open_loop_plan import Start, plan_simulation, read_state
from clepsydra.loop.profile import read_change
from clepsydra.loop.solver import Solver
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process


def simulate(
    process: Process | str,
    inputs: Mapping[str, str | Sequence[str]] | None = None,
    *,
    duration: str | None = None,
    start: Start = "rest",
    state: Mapping[str, str] | None = None,
    solver: Solver = "kernel",
) -> Simulation:
    """Simulate a process without a controller.

    Parameters
    ----------
    process : Process or str
        Or its name or path.
    inputs : mapping, optional
        Input or disturbance to what it does: "3.2 V" from the start, "3.5 V @ 60 s" for a step,
        "4 V @ 60 s..120 s" for a ramp, or a list of these in order of time. Signals that are not
        named stay at their values at rest.
    duration : str, optional
        "20 min"; if left out, long enough that what the last change does has ended: six times
        the slowest time constant after it, longer for equal tanks in series and for dead times.
    start : {"rest", "empty"}
    state : mapping, optional
        States that start elsewhere, "tank_1.level" to "5 cm".
    solver : {"kernel", "reference"}

    Returns
    -------
    Simulation
        With trajectories, events, balances and an estimate of its error.

    Raises
    ------
    InputError
        A name is unknown, a quantity has no unit or the wrong one, a value is out of range, or
        the times are out of order.
    NoEquilibrium
        It starts at rest, and the process does not rest anywhere.

    Examples
    --------
    >>> run = simulate("quadruple-tank", {"pump_1": "3.2 V @ 60 s"}, duration="20 min")
    >>> round(100 * float(run.values["tank_1.level"][-1]), 2)  # [cm]
    13.32
    """
    plant = process if isinstance(process, Process) else load_process(process)
    require_type(
        inputs if inputs is not None else {}, Mapping, "inputs", "a mapping from names to words",
        'write as in {"pump_1": "3.2 V"}',
    )  # fmt: skip
    changes = [
        read_change(name, words, plant, f"inputs, {name}")
        for name, said in (inputs or {}).items()
        for words in ([said] if isinstance(said, str) or not isinstance(said, Sequence) else said)
    ]
    values = {name: read_state(name, v, plant, "state") for name, v in (state or {}).items()}
    return plan_simulation(plant, changes, duration=duration, start=start, state=values).run(solver)
