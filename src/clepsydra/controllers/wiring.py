"""Which signal of a loop each signal of a step law is wired to."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.signals import owners
from clepsydra.process.process import Process
from clepsydra.program.step_law import StepLaw


def wired_setpoints(law: StepLaw, free: Collection[str]) -> tuple[str, ...]:
    """Return whose setpoints a loop wires: those of a law's inputs that are not free."""
    return tuple(y for y in owners(law.inputs, "sp") if path(y, "sp") not in free)


def input_wires(
    law: StepLaw, measurements: Sequence[str], setpoints: Sequence[str], manipulated: Sequence[str]
) -> dict[str, str]:
    """Return law input to the loop's signal; the time step is not wired."""
    wires: dict[str, str] = {}
    for owner, name in zip(owners(law.inputs, "pv"), measurements, strict=False):
        wires |= {path(owner, "pv"): name, path(owner, "good"): path(name, "sensor")}
    for owner, name in zip(owners(law.inputs, "sp"), setpoints, strict=False):
        wires[path(owner, "sp")] = path(name, "setpoint")
    for owner, name in zip(owners(law.outputs, "out"), manipulated, strict=False):
        wires |= {path(owner, what): path(name, what) for what in ("mode", "manual", "tracking")}
    return wires


def output_wires(law: StepLaw, manipulated: Sequence[str]) -> dict[str, str]:
    """Return law output to the loop's signal."""
    wires: dict[str, str] = {}
    for owner, name in zip(owners(law.outputs, "out"), manipulated, strict=False):
        wires |= {path(owner, "out"): name, path(owner, "status"): path(name, "status")}
    return wires


def check_wiring(
    law: StepLaw,
    measurements: Sequence[str],
    setpoints: Sequence[str],
    manipulated: Sequence[str],
    place: str,
    free: Collection[str] = (),
    free_outputs: Collection[str] = (),
) -> None:
    """Refuse names that are not one for each signal of a law.

    `measurements`, `setpoints`, `manipulated`: names of process signals; `place`: the controller's
    name, for the message; `free`: inputs that nothing of the process drives; `free_outputs`:
    outputs that nothing of the process takes.

    Raises InputError: there are more or fewer names than the law has signals, an input is moved
    twice, or the law has a signal that nothing is wired to.

    Examples
    --------
    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"])
    >>> check_wiring(law, ["level_1"], ["level_1"], ["pump_1"], "PI")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: PI, measurements: got ['level_1'], expected 2 names, one \
for each measurement of the law; name them.
    """
    inputs = [signal.name for signal in law.inputs]
    outputs = [signal.name for signal in law.outputs]
    for what, names, known, part, words in (
        ("measurements", measurements, law.inputs, "pv", "measurement"),
        ("setpoints", setpoints, law.inputs, "sp", "setpoint"),
        ("manipulated", manipulated, law.outputs, "out", "manipulated"),
    ):
        count = sum(path(owner, part) not in free for owner in owners(known, part))
        names_given = isinstance(names, (tuple, list)) and all(isinstance(n, str) for n in names)
        if not names_given or len(names) != count:
            got = list(names) if names_given else names
            expected = f"{count} names, one for each {words} of the law"
            raise InputError(f"{place}, {what}", got, expected, "name them")
    if len(set(manipulated)) < len(manipulated):
        raise InputError(
            f"{place}, manipulated", list(manipulated), "each name once", "move each input once"
        )
    wired = input_wires(law, measurements, setpoints, manipulated)
    wired |= output_wires(law, manipulated)
    for what, given, own, words in (
        ("free inputs", free, inputs, "input of the law that nothing drives"),
        ("free outputs", free_outputs, outputs, "output of the law that nothing takes"),
    ):
        for name in given:
            if name not in own or name in wired:
                raise InputError(f"{place}, {what}", name, f"an {words}", "correct the name")
    possible = {*wired, *free, *free_outputs, "time_step"}
    for name in (*inputs, *outputs):
        if name not in possible:
            expected = f"a signal that a loop can wire: one of {', '.join(wired)} or time_step"
            remedy = "rename it, or make it a parameter"
            raise InputError(f"{place}, law {law.name}", name, expected, remedy)


def check_signals(
    measurements: Sequence[str],
    setpoints: Sequence[str],
    manipulated: Sequence[str],
    place: str,
    process: Process,
) -> None:
    """Refuse names of process signals that a process lacks.

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> check_signals(["level_1"], ["level_1"], ["pmup_1"], "PI", process)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: PI, manipulated: got 'pmup_1', expected an input of \
quadruple-tank: pump_1, pump_2; perhaps 'pump_1' was meant.
    """
    measured, inputs = ([s.name for s in each] for each in (process.measurements, process.inputs))
    for what, names, kind, known in (
        ("measurements", measurements, "a measurement", measured),
        ("setpoints", setpoints, "a controlled measurement", process.controlled),
        ("manipulated", manipulated, "an input", inputs),
    ):
        for name in names:
            if name not in known:
                raise InputError(
                    f"{place}, {what}", name, f"{kind} of {process.name}: {', '.join(known)}",
                    suggestion(name, known, "correct the name"),
                )  # fmt: skip


def controller_name(signal: str) -> str:
    """Return the name that a state or parameter of a step law has in the closed loop."""
    return f"controller.{signal}"
