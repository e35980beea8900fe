"""The plant shell: what a plant needs around a law, as a step law around a step law."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.controllers.plant_shell.fail_safe import TAKE_UP_SCANS, SafeOutput
from clepsydra.controllers.plant_shell.members import Members, members_of
from clepsydra.controllers.plant_shell.ports import largest_rate
from clepsydra.controllers.plant_shell.scan_watch import (
    SAMPLING_PERIOD,
    SCAN_TOLERANCE,
    SCAN_WATCH,
)
from clepsydra.controllers.plant_shell.sensor_diagnosis import MonitoredSensor
from clepsydra.controllers.plant_shell.setpoint_ramp import RampedSetpoint
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.start import START
from clepsydra.controllers.plant_shell.status import status_signal
from clepsydra.controllers.plant_shell.step import ShellStep
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.program.entries import signal_of
from clepsydra.program.step_law import StepLaw, step_law

_DESCRIPTION = (
    "Plant shell around the law: sensors are judged by their currents (NAMUR NE 43), a fault is "
    "ridden through for its delay and then brings the outputs that need the sensor to their "
    "fail-safe values, until it is acknowledged.",
    "Setpoints follow a ramp, outputs a rate limit; the scan time is checked; a start may be cold "
    "or warm; the watchdog counts the scans.",
)


@dataclass(frozen=True)
class ShelledController(Controller):
    """A controller behind a plant shell.

    Parameters
    ----------
    bare : Controller or None
        The controller without the shell.
    sources : dict
        Parameter of the shell to where its number comes from.

    Examples
    --------
    >>> ShelledController.__mro__[1].__name__
    'Controller'
    """

    bare: Controller | None = None
    sources: dict[str, str] = field(default_factory=dict)


def shell_sources(controller: Controller) -> dict[str, str]:
    """Return for each parameter of the shell where its number comes from; empty without a shell.

    Examples
    --------
    >>> import clepsydra as cl
    >>> shelled = with_plant_shell(cl.design.simc(cl.load("quadruple-tank")), 1.0)
    >>> shell_sources(shelled)["pump_1.fail_safe"]
    'default: low limit of pump_1'
    """
    return dict(controller.sources) if isinstance(controller, ShelledController) else {}


def with_plant_shell(
    controller: Controller, sampling_period: float, settings: PlantShell | None = None
) -> ShelledController:
    """Put a controller into a plant shell.

    The shell is a step law around the law: it judges the sensors, holds and at last brings the
    outputs to fail-safe values, lets setpoints follow ramps and outputs rate limits, checks the
    time between two scans, starts cold or warm, counts the scans, and tells all of it in the
    status words (`plant_shell.status`). With sound signals and without settings it is the law
    itself, in every bit.

    Parameters
    ----------
    controller : Controller
    sampling_period : float
        That the controller was designed for [s].
    settings : PlantShell, optional

    Returns
    -------
    ShelledController
        Inputs of the controller, and the free inputs start (0 runs on, 1 warm, 2 cold) and
        acknowledge; its outputs, and watchdog. Beside its parameters: range_low and range_high
        [measurement unit] where the range is known, sensor_delay [s] and setpoint_rate [unit/s] of
        the measurements; fail_safe and rate_limit [unit/s], where it can be limited, of the
        outputs; sampling_period [s], scan_tolerance and take_up_scans.

    Raises
    ------
    InputError
        The law is written in Python, lacks an input that the shell needs or uses a name of the
        shell; the sampling period is no time; or a setting does not fit the controller.

    References
    ----------
    NAMUR NE 43, Standardization of the signal level for the failure information of digital
    transmitters.

    Examples
    --------
    >>> import clepsydra as cl
    >>> shelled = with_plant_shell(cl.design.simc(cl.load("quadruple-tank")), 1.0)
    >>> shelled.law.name, shelled.free_inputs, shelled.free_outputs
    ('multiloop_pi_with_shell', {'start': 0.0, 'acknowledge': 0.0}, ('watchdog',))
    """
    require_type(controller, Controller, "controller", "a Controller", "design one, or make one")
    place = f"{controller.name}, plant shell"
    if not is_finite_number(sampling_period) or not (
        signals.SHORTEST_TIME <= sampling_period <= signals.LARGEST_PARAMETER
    ):
        raise InputError(
            f"{place}, sampling period", sampling_period,
            f"a time from {signals.SHORTEST_TIME:g} to {signals.LARGEST_PARAMETER:g} s",
            "give the sampling period in seconds",
        )  # fmt: skip
    chosen = settings or PlantShell()
    require_type(chosen, PlantShell, "settings", "a PlantShell", "write as in PlantShell()")
    _check_law(controller.law, place)
    members = members_of(controller, chosen, float(sampling_period))
    return _shelled(controller, float(sampling_period), chosen, members)


def _check_law(law: StepLaw, place: str) -> None:
    """Refuse a law that the shell cannot go around."""
    if isinstance(law, PythonLaw):
        raise InputError(
            place, f"{law.name}, a law in Python",
            "a law of expressions: one in Python has none that could be put into a shell",
            "write it as expressions, by step_law",
        )  # fmt: skip
    names = {signal.name for signal in law.inputs}
    needed = ["time_step"]
    needed += [path(owner, "good") for owner in owners(law.inputs, "pv")]
    for owner in owners(law.outputs, "out"):
        needed += [path(owner, what) for what in ("mode", "manual", "tracking")]
    for name in needed:
        if name not in names:
            raise InputError(
                f"{place}, law {law.name}", f"no input {name}", "a law with it",
                "leave the status of outputs out of the law, so that modes, limits and sensor "
                "faults are added",
            )  # fmt: skip


def _shelled(
    bare: Controller, period: float, settings: PlantShell, members: Members
) -> ShelledController:
    """Return the controller behind the shell that its members make."""
    law = bare.law
    asked, watchdog = START.inputs[:2], SCAN_WATCH.outputs[-1]
    *begun, acknowledge = map(signal_of, START.state)
    every: list[MonitoredSensor | RampedSetpoint | SafeOutput] = [
        *members.sensors,
        *members.setpoints,
        *members.outputs,
    ]
    parameters = [p for member in every for p in member.parameters()]
    parameters += [
        largest_rate("rate_limit", output.signal, members.rates[output.signal.name])
        for output in members.outputs
        if output.signal.name in members.rates
    ]
    chosen = (
        (SAMPLING_PERIOD, period),
        (SCAN_TOLERANCE, settings.scan_tolerance),
        (TAKE_UP_SCANS, float(members.take_up_scans)),
    )
    parameters += [replace(parameter, initial=value) for parameter, value in chosen]
    kept = {entry.name for entry in law.state}
    # A law that does not remember what was applied leaves that to the shell.
    last = [signals.last_output(output.signal) for output in members.outputs]
    state = [s for member in every for s in member.state()]
    state += [
        *(s for s in last if s.name not in kept),
        acknowledge,
        *map(signal_of, SCAN_WATCH.state),
    ]
    _check_clashes(bare, [*asked, *parameters, *state, *begun, watchdog])
    initial = {**bare.initial_state, **{signal.name: signal.initial for signal in state}}
    # An input that nobody wires is to be seen: no sensor, manual, and no time between two scans.
    unwired = {"time_step": 0.0}
    for sensor in members.sensors:
        unwired |= sensor.unwired()
    for output in members.outputs:
        unwired |= output.unwired()
    inputs = [replace(s, initial=unwired.get(s.name, s.initial)) for s in law.inputs]
    step = ShellStep(law, members, [*law.state, *state], initial)
    shelled = step_law(
        f"{law.name}_with_shell",
        inputs=[*inputs, *asked],
        parameters=[*law.parameters, *parameters],
        state=[*law.state, *state, *begun],
        outputs=[*map(_with_shell_status, law.outputs), watchdog],
        equations=step.equations,
        description=(*law.description, *_DESCRIPTION),
        blocks=law.blocks,
    )
    return ShelledController(
        name=bare.name,
        family=bare.family,
        design=bare.design,
        law=shelled,
        values={**bare.values, **members.own_rates, **{p.name: p.initial for p in parameters}},
        initial_state={**initial, **{s.name: 0.0 for s in begun}},
        measurements=bare.measurements,
        setpoints=bare.setpoints,
        manipulated=bare.manipulated,
        notes=(*bare.notes, *members.notes),
        free_inputs={**bare.free_inputs, "start": 0.0, "acknowledge": 0.0},
        free_outputs=(*bare.free_outputs, watchdog.name),
        slowed=bare.slowed,
        bare=bare,
        sources=members.sources,
    )


def _check_clashes(bare: Controller, added: Iterable[Signal]) -> None:
    """Refuse a law that uses a name of the shell for something else."""
    law = bare.law
    taken = {e.name for e in (*law.inputs, *law.parameters, *law.state, *law.outputs)}
    for signal in added:
        if signal.name in taken:
            raise InputError(
                f"{bare.name}, plant shell, law {law.name}", signal.name,
                "a law that leaves this name to the shell", "rename it in the law",
            )  # fmt: skip


def _with_shell_status(signal: Signal) -> Signal:
    return status_signal(signal) if signal.part == "status" else signal
