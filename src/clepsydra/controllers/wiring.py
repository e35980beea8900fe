"""Which signal of a loop each signal of a step law is wired to."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from clepsydra.base.errors import InputError
from clepsydra.program.step_law import StepLaw


def input_wires(
    measurements: Sequence[str], setpoints: Sequence[str], manipulated: Sequence[str]
) -> dict[str, str]:
    """Return law input to the loop's signal; the time step is not wired.

    Examples
    --------
    >>> input_wires(["level_1"], [], ["pump_1"])["mode_1"]
    'pump_1.mode'
    """
    wires: dict[str, str] = {}
    for number, name in enumerate(measurements, 1):
        wires |= {f"measurement_{number}": name, f"sensor_{number}": f"{name}.sensor"}
    for number, name in enumerate(setpoints, 1):
        wires[f"setpoint_{number}"] = f"{name}.setpoint"
    for number, name in enumerate(manipulated, 1):
        for what in ("mode", "manual", "tracking"):
            wires[f"{what}_{number}"] = f"{name}.{what}"
    return wires


def output_wires(manipulated: Sequence[str]) -> dict[str, str]:
    """Return law output to the loop's signal.

    Examples
    --------
    >>> output_wires(["pump_1"])
    {'manipulated_1': 'pump_1', 'status_1': 'pump_1.status'}
    """
    wires: dict[str, str] = {}
    for number, name in enumerate(manipulated, 1):
        wires |= {f"manipulated_{number}": name, f"status_{number}": f"{name}.status"}
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
    >>> check_wiring(multiloop_pid_law(2), ["level_1"], ["level_1"], ["pump_1"], "PI")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: PI, measurements: got ['level_1'], expected 2 names, one \
for each measurement of the law; name them.
    """
    inputs = [signal.name for signal in law.inputs]
    outputs = [signal.name for signal in law.outputs]
    for what, names, known, prefix in (
        ("measurements", measurements, inputs, "measurement_"),
        ("setpoints", setpoints, inputs, "setpoint_"),
        ("manipulated", manipulated, outputs, "manipulated_"),
    ):
        count = sum(name.startswith(prefix) and name not in free for name in known)
        names_given = isinstance(names, (tuple, list)) and all(isinstance(n, str) for n in names)
        if not names_given or len(names) != count:
            raise InputError(
                f"{place}, {what}",
                list(names) if names_given else names,
                f"{count} names, one for each {prefix.removesuffix('_')} of the law",
                "name them",
            )
    if len(set(manipulated)) < len(manipulated):
        raise InputError(
            f"{place}, manipulated", list(manipulated), "each name once", "move each input once"
        )
    wired = input_wires(measurements, setpoints, manipulated) | output_wires(manipulated)
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
