"""The plant shell: what a plant needs around a law, as a step law around a step law."""

from __future__ import annotations

import math
from collections.abc import Container, Iterable
from dataclasses import dataclass, field, fields, replace

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal, owned, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.status import status_port
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.members import Members
from clepsydra.controllers.plant_shell.parameter_check import last_valid
from clepsydra.controllers.plant_shell.scan import ASKED, WATCHDOG, scan_start
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.signal_check import RAMP, signal_check
from clepsydra.controllers.plant_shell.status import STATE as COMMAND_STATE
from clepsydra.controllers.plant_shell.status import conditions, status_bits
from clepsydra.controllers.plant_shell.step import ShellScan
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.program.delay_ring import DelayRing
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

    `bare`: the controller without the shell; `sources`: parameter of the shell to where its number
    comes from.
    """

    bare: Controller | None = None
    sources: dict[str, str] = field(default_factory=dict)


def shell_sources(controller: Controller) -> dict[str, str]:
    """Return for each parameter of the shell where its number comes from; empty without a shell."""
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

    `sampling_period`: that the controller was designed for [s].

    Returns
    -------
    ShelledController
        Inputs of the controller, and the free inputs start (0 runs on, 1 warm, 2 cold) and
        acknowledge; its outputs, and watchdog. Beside its parameters: range_low and range_high
        [measurement unit] where the range is known, sensor_delay [s] and setpoint_rate [unit/s] of
        the measurements; fail_safe and rate_limit [unit/s], where it can be limited, of the
        outputs; sampling_period [s], scan_tolerance and take_up_scans.

    Raises InputError: the law is written in Python, lacks an input that the shell needs or uses a
    name of the shell; or a setting does not fit the controller.

    References
    ----------
    NAMUR NE 43, Standardization of the signal level for the failure information of digital
    transmitters.
    """
    _check_law(controller.law, f"{controller.name}, plant shell")
    return _shelled(
        controller, Members(controller, settings or PlantShell(), float(sampling_period))
    )


def _check_law(law: StepLaw, place: str) -> None:
    """Refuse a law that the shell cannot go around."""
    if isinstance(law, PythonLaw):
        raise InputError(
            place, f"{law.name}, a law in Python",
            "a law of expressions: one in Python has none that could be put into a shell",
            "write it as expressions, by step_law, or take another controller",
        )  # fmt: skip
    names = {signal.name for signal in law.inputs}
    needed = ["time_step"]
    needed += [path(owner, "good") for owner in owners(law.inputs, "pv")]
    for owner in owners(law.outputs, "out"):
        needed += [path(owner, what) for what in ("mode", "manual", "tracking")]
    for name in needed:
        if name not in names:
            raise InputError(
                f"{place}, law {law.name}", Finding(f"no input {name}"), "a law with it",
                "leave the status of outputs out of the law, so that modes, limits and sensor "
                "faults are added",
            )  # fmt: skip


def _shelled(bare: Controller, members: Members) -> ShelledController:
    """Return the controller behind the shell that its members make."""
    law = bare.law
    states = [
        *((port, y) for y in members.sensors for port in signal_check(ranged=True).state),
        *((port, signal) for signal, _ in members.setpoints for port in RAMP.state),
        *((port, u) for u in members.outputs for port in COMMAND_STATE),
    ]
    kept = {entry.name for entry in law.state}
    # A law that does not remember what was applied leaves that to the shell.
    last = [signals.last_output(output) for output in members.outputs]
    begun = map(signal_of, scan_start(delays=False).state)
    added = [*(_of_process(*each) for each in states), *(s for s in last if s.name not in kept)]
    added += begun
    values = bare.values | members.own_rates | {p.name: p.initial for p in members.parameters}
    added += [
        replace(last_valid(parameter), initial=values[parameter.name])
        for check in members.checks
        for parameter in check.state.values()
    ]
    _check_clashes(bare, [*ASKED, *members.interlocks, *members.parameters, *added, WATCHDOG])
    state = [*law.state, *added]
    initial = {**bare.initial_state, **{signal.name: signal.initial for signal in added}}
    held = members.interlocked
    shown = [
        told for u in members.outputs for told in owned(u, conditions(interlocked=u.name in held))
    ]
    shown += [seen for loop in members.loops for seen in loop.faceplate()]
    shelled = step_law(
        f"{law.name}_with_shell",
        inputs=[
            *(replace(s, initial=members.unwired.get(s.name, s.initial)) for s in law.inputs),
            *ASKED,
            *members.interlocks,
        ],
        parameters=[*law.parameters, *members.parameters],
        state=state,
        outputs=[*(_with_shell_status(each, held) for each in law.outputs), *shown, WATCHDOG],
        equations=lambda symbols: ShellScan(members, symbols, state, initial).equations(),
        description=(*law.description, *_DESCRIPTION),
        blocks=law.blocks,
    )
    whole = {entry.name: getattr(bare, entry.name) for entry in fields(Controller)}
    whole |= {
        "law": shelled,
        "values": values,
        "initial_state": initial,
        "notes": (*bare.notes, *members.notes),
        "free_inputs": {
            **bare.free_inputs,
            **{signal.name: 0.0 for signal in (*ASKED, *members.interlocks)},
        },
        "free_outputs": (*bare.free_outputs, *(s.name for s in (*shown, WATCHDOG))),
    }
    return ShelledController(**whole, bare=bare, sources=members.sources)


def _of_process(entry: Signal | DelayRing, signal: Signal) -> Signal:
    """Return the state of a block that belongs to a process signal, as a state of the law."""
    port = signal_of(entry)
    name, words = path(signal, port.name), f"{signal.name}: {port.description}"
    # A time is not in the unit of the process signal.
    if port.kind != "real" or port.unit != "1":
        return replace(port, name=name, description=words)
    initial = signal.initial if math.isfinite(signal.initial) else 0.0
    return replace(signal, name=name, initial=initial, description=words)


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


def _with_shell_status(signal: Signal, interlocked: Container[str]) -> Signal:
    if signal.part != "status":
        return signal
    bits = status_bits(interlocked=signal.owner in interlocked)
    return replace(status_port(bits), name=signal.name)
