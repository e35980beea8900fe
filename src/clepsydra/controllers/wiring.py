"""Which signal of a loop each signal of a step law is wired to."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.controllers.signals import owners
from clepsydra.program.step_law import StepLaw


def wired_setpoints(law: StepLaw, free: Collection[str]) -> tuple[str, ...]:
    """Return whose setpoints a loop wires: those of a law's inputs that are not free.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> wired_setpoints(multiloop_pid_law(["level"], ["pump"]), {"level.sp": 3.0})
    ()
    """
    return tuple(y for y in owners(law.inputs, "sp") if path(y, "sp") not in free)


def input_wires(
    law: StepLaw, measurements: Sequence[str], setpoints: Sequence[str], manipulated: Sequence[str]
) -> dict[str, str]:
    """Return law input to the loop's signal; the time step is not wired.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level"], ["pump"])
    >>> input_wires(law, ["level_1"], [], ["pump_1"])["pump.mode"]
    'pump_1.mode'
    """
    wires: dict[str, str] = {}
    for owner, name in zip(owners(law.inputs, "pv"), measurements, strict=False):
        wires |= {path(owner, "pv"): name, path(owner, "good"): path(name, "sensor")}
    for owner, name in zip(owners(law.inputs, "sp"), setpoints, strict=False):
        wires[path(owner, "sp")] = path(name, "setpoint")
    for owner, name in zip(owners(law.outputs, "out"), manipulated, strict=False):
        wires |= {path(owner, what): path(name, what) for what in ("mode", "manual", "tracking")}
    return wires


def output_wires(law: StepLaw, manipulated: Sequence[str]) -> dict[str, str]:
    """Return law output to the loop's signal.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> output_wires(multiloop_pid_law(["level"], ["pump"]), ["pump_1"])
    {'pump.out': 'pump_1', 'pump.status': 'pump_1.status'}
    """
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

    Parameters
    ----------
    law : StepLaw
    measurements, setpoints, manipulated : sequence of str
        Names of process signals.
    place : str
        The controller's name, for the message.
    free : collection of str
        Inputs that nothing of the process drives.
    free_outputs : collection of str
        Outputs that nothing of the process takes.

    Raises
    ------
    InputError
        There are more or fewer names than the law has signals, an input is moved twice, or
        the law has a signal that nothing is wired to.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
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
            raise InputError(
                f"{place}, {what}",
                list(names) if names_given else names,
                f"{count} names, one for each {words} of the law",
                "name them",
            )
    if len(set(manipulated)) < len(manipulated):
        raise InputError(
            f"{place}, manipulated", list(manipulated), "each name once", "move each input once"
        )
    wired = input_wires(law, measurements, setpoints, manipulated)
    wired |= output_wires(law, manipulated)
    for name in free:
        if name not in inputs or name in wired:
            raise InputError(
                f"{place}, free inputs", name, "an input of the law that nothing drives",
                "correct the name",
            )  # fmt: skip
    for name in free_outputs:
        if name not in outputs or name in wired:
            raise InputError(
                f"{place}, free outputs", name, "an output of the law that nothing takes",
                "correct the name",
            )  # fmt: skip
    possible = {*wired, *free, *free_outputs, "time_step"}
    for name in (*inputs, *outputs):
        if name not in possible:
            raise InputError(
                f"{place}, law {law.name}",
                name,
                f"a signal that a loop can wire: one of {', '.join(wired)} or time_step",
                "rename it, or make it a parameter",
            )
