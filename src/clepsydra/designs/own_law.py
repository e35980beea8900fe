"""A controller with a user's own step law, wired to a process at its operating point."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from clepsydra.base.arguments import require_type, sequence_of
from clepsydra.base.signal import path
from clepsydra.base.vanishing import vanishing
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.controllers.wiring import check_signals
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.program.step_law import StepLaw


def own_controller(
    model: LinearModel,
    law: StepLaw,
    *,
    measurements: Sequence[str],
    setpoints: Sequence[str],
    manipulated: Sequence[str],
    values: Mapping[str, float] | None = None,
    initial_state: Mapping[str, float] | None = None,
    free_inputs: Mapping[str, float] | None = None,
    name: str = "Own law",
) -> Controller:
    """Return a controller with an own law, whose outputs start at the operating point.

    Parameters
    ----------
    law : StepLaw
        Of `controllers.own_law.load_law`, say.
    measurements, setpoints, manipulated : sequence of str
        Process signals of each pv, sp and out of the law, in their order.
    values : mapping, optional
        Parameters that differ from their initial values; the limits of an output are the range
        of what it moves where nothing else is given.
    initial_state : mapping, optional
        States that do not start at their initial values.
    free_inputs : mapping, optional
        As in `Controller`.
    name : str
        What the reader sees.

    Raises
    ------
    InputError
        The model has no operating point, the process lacks a signal, or a name or a number is
        wrong.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.controllers.python_law import python_law
    >>> law = python_law("still", lambda state, inputs, parameters, time_step:
    ...                  ({}, {"pump_1.out": inputs["pump_1.last_output"]}),
    ...                  inputs=[Signal("level_1.pv")], outputs=[Signal("pump_1.out")])
    >>> controller = own_controller(
    ...     cl.load("quadruple-tank").linear, law, measurements=["level_1"],
    ...     setpoints=[], manipulated=["pump_1"])
    >>> controller.initial_state, controller.values
    ({'pump_1.last_output': 3.0}, {'pump_1.low_limit': 0.0, 'pump_1.high_limit': 10.0})
    """
    require_type(law, StepLaw, "law", "a StepLaw", "read it with load_law(path)")
    wires = {"measurements": measurements, "setpoints": setpoints, "manipulated": manipulated}
    expected, example = "a list of names of signals", 'write as in ["level_1"]'
    for key, names in wires.items():
        sequence_of(names, str, f"{name}, {key}", expected, example)
    numbers = {"values": values, "initial_state": initial_state, "free_inputs": free_inputs}
    expected, example = "names with their numbers", 'write as in {"gain": 2.0}'
    for key, given in numbers.items():
        require_type(given or {}, Mapping, f"{name}, {key}", expected, example)
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    check_signals(measurements, setpoints, manipulated, name, process)
    known = {parameter.name: parameter.initial for parameter in law.parameters}
    start = {entry.name: getattr(entry, "initial", 0.0) for entry in law.state}
    for owner, moved in zip(owners(law.outputs, "out"), manipulated, strict=False):
        signal = process.signal(moved)
        for part, value in (("low_limit", signal.low), ("high_limit", signal.high)):
            if (limit := path(owner, part)) in known:
                known[limit] = value
        if (last := path(owner, "last_output")) in start:
            start[last] = at[moved]
    return Controller(
        name=name,
        family="own law",
        design="Given by the user" + (", in Python." if isinstance(law, PythonLaw) else "."),
        law=law,
        values=known | dict(values or {}),
        initial_state=start | dict(initial_state or {}),
        measurements=tuple(measurements),
        setpoints=tuple(setpoints),
        manipulated=tuple(manipulated),
        notes=law.notes or _notes_on(law),
        free_inputs=dict(free_inputs or {}),
    )


def _notes_on(law: StepLaw) -> tuple[str, ...]:
    """Return which idioms vanish from the equations of a law that no file was read for.

    Where they cannot be seen, as in a lambda within a call, none are.
    """
    written: Any = law.equations
    if str(getattr(written, "__module__", "")).partition(".")[0] == __name__.partition(".")[0]:
        return ()
    try:
        lines, first = inspect.getsourcelines(written)
        found = vanishing(textwrap.dedent("".join(lines)))
    except (OSError, TypeError, SyntaxError):
        return ()
    here = Path(inspect.getsourcefile(written) or law.name).name
    return tuple(replace(each, line=each.line + first - 1).told(here) for each in found)
