"""What a page measures of a run between two steps of a task."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

from clepsydra.base.arguments import require_known
from clepsydra.base.quantity import quantity
from clepsydra.laboratory.lessons.bands import seen_signals
from clepsydra.process import told
from clepsydra.process.declared import OWN, choice, keys_of, part, read_fields
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

#: By the definitions of `clepsydra.scores`, and a mean: where a level rests whose pumps are noisy.
Kind = Literal["mean", "rise_time", "overshoot", "settling_time", "return_time"]
#: Where a step goes, and around what settling and return are: the setpoint, or where the stretch
#: ends, as by hand.
Target = Literal["setpoint", "end"]
_EXAMPLE = 'write as in measure = { kind = "overshoot", signal = "level_1" }'


def _signal(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
    process = known["process"]
    seen = seen_signals(process)
    parameters = {each.name for each in process.parameters}
    names = [name for name in seen if name not in parameters and not name.endswith(".mode")]
    name = table.text(key, "the name of a signal", _EXAMPLE)
    require_known(table.place(key), name, names, f"a signal of {process.name}")
    if (
        table.choice("target", get_args(Target), "setpoint") == "setpoint"
        and known["kind"] != "mean"
    ):
        words = f"a controlled measurement of {process.name}"
        require_known(table.place(key), name, process.controlled, words)
    return name


def _step(*, last: bool) -> Any:
    """Return the field of the number of a step, counted from 1; the last one or 0 if left out."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> int:
        steps = known["steps"]
        value = table.raw(key) if table.has(key) else steps if last else 0
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= steps:
            expected = f"the number of a step of the task, 1 to {steps}, or 0 for its beginning"
            raise table.wrong(key, expected, "correct it")
        return value

    return part(read, description="the step that it counts from or to", type="integer", minimum=0)


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A number of a stretch of a run.

    Parameters
    ----------
    kind : str
    signal : str
    target : {"setpoint", "end"}
    after, until : int
        The steps of the task that begin and end the stretch; 0 is where the task began.
    band : float
        Half the width of the band of settling and return, as a share of the step or the target.
    """

    kind: Kind = choice(get_args(Kind), words="what is measured")
    signal: str = part(_signal, required=(OWN,), **told.text("of what"))
    target: Target = choice(get_args(Target), words="where the signal is to go")
    after: int = _step(last=False)
    until: int = _step(last=True)
    band: float = quantity(
        "1",
        "a share",
        above=0.0,
        at_most=1.0,
        default=0.05,
        remedy="leave it out for 5 %",
    )

    def unit(self, process: Process) -> str:
        """Return the SI unit of what it measures."""
        if self.kind == "mean":
            return seen_signals(process)[self.signal].unit
        return "1" if self.kind == "overshoot" else "s"


def read_measure(table: TableReader, key: str, **known: Any) -> Measure | None:
    """Read what a figure measures; None where the reader types it.

    Raises
    ------
    InputError
        The signal is none of the rig, or the task has no such step.
    """
    if not table.has(key):
        return None
    rows = table.table(key, "what is measured", _EXAMPLE, keys_of(Measure))
    found = Measure(**read_fields(Measure, rows, **known))
    if not found.after < found.until:
        raise rows.wrong("until", "a step behind `after`", "give the task steps, [[tasks.reach]]")
    return found
