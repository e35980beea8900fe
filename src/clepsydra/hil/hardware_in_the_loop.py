"""Hardware in the loop: every PLC that can be had here, on every kind of wires, in every case."""

from __future__ import annotations

import math
import socket
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from clepsydra.controllers.plant_shell.signal_check import SENSOR_DELAY
from clepsydra.deploy.exportable import Exportable
from clepsydra.deploy.matiec import Absent
from clepsydra.hil.building import c_image, structured_text_image
from clepsydra.hil.case import CASES, Case, Subject, Verdict
from clepsydra.hil.controller_image import ControllerImage
from clepsydra.hil.trial import Tried, tried
from clepsydra.hil.wires import Wires, modbus_wires, opc_ua_wires
from clepsydra.hil.wiring import check_units
from clepsydra.program.precision import Precision
from clepsydra.rig.doors.door import Door
from clepsydra.rig.running import RunningRig
from clepsydra.rig.settings import RigSettings

#: Periods of the plant by a real clock that are tried, the fastest first [s].
PERIODS = (0.02, 0.05, 0.1)
#: A controller is silent for its rig after so many periods, and at least so long [s].
_SILENT_PERIODS, _SILENT = 10, 0.2
#: How a controller gets into a PLC, by what the command line calls it.
PLCS: dict[str, Callable[[Exportable, Path, Precision], ControllerImage]] = {
    "st": structured_text_image,
    "c": c_image,
}
WIRES: tuple[str, ...] = ("modbus", "opc-ua")
#: A loop that is left alone, to see which speed this machine holds.
_IN_TIME = {
    "in-time": Case(
        0, "in time", True, lambda subject: {}, lambda subject: 100,
        lambda episode: Verdict(True, "left alone"),
    )
}  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """What is tried.

    Parameters
    ----------
    plcs : sequence of str
        Of `PLCS`.
    wires : sequence of str
        Of `WIRES`.
    precision : {"double", "single"}
    encoding : str
        Of values in registers, see `clepsydra.rig.doors.modbus.encoding.Encoding`.
    period : float, optional
        Of the plant by a real clock [s]; the fastest that is met if left out.
    """

    plcs: Sequence[str] = tuple(PLCS)
    wires: Sequence[str] = WIRES
    precision: Precision = "double"
    encoding: str = "counts-27648"
    period: float | None = None


@dataclass(frozen=True)
class HardwareInTheLoop:
    """What hardware in the loop has shown.

    Parameters
    ----------
    title : str
        Of the controller and its process.
    tried : tuple of Tried
    left_out : tuple of (str, str)
        What could not be had here, and why.
    """

    title: str
    tried: tuple[Tried, ...]
    left_out: tuple[tuple[str, str], ...]

    @property
    def holds(self) -> bool:
        """Whether something was tried, and all of it holds."""
        return bool(self.tried) and all(each.holds for each in self.tried)


def hardware_in_the_loop(
    settings: RigSettings,
    ready: Exportable,
    asked: Asked,
    progress: Callable[[str], None] = lambda words: None,
) -> HardwareInTheLoop:
    """Put an exported controller into PLCs, and their wires and its plant into all cases.

    Parameters
    ----------
    settings : RigSettings
        Of the rig, without doors; its folder is where each trial has its own.
    ready : Exportable
    asked : Asked
    progress : callable, optional
        Takes what is tried next.

    Raises
    ------
    InputError
        The controller cannot be exported or wired.
    """
    check_units(ready, settings.tags)
    left_out, found = [], []
    with TemporaryDirectory() as name:
        images: list[ControllerImage] = []
        for plc in asked.plcs:
            try:
                images.append(PLCS[plc](ready, Path(name, plc), asked.precision))
            except Absent as absent:
                left_out.append((plc, str(absent)))
        pairs = [(image, wires) for image in images for wires in asked.wires]
        period = asked.period
        for number, (image, wires) in enumerate(pairs, 1):
            own = replace(settings, folder=settings.folder / f"{number}-{wires}")
            if period is None:
                progress("the fastest speed that this machine holds")
                period = _fastest(own, ready, asked, image, wires)
            progress(f"{image.title}, {wires}, a sample each {1000 * period:g} ms")
            trial = _trial(own, ready, asked, image, wires, period, CASES)
            slower = [] if asked.period else [each for each in PERIODS if each > period]
            while not trial.holds and not trial.timing.is_met and slower:
                period = slower.pop(0)
                progress(f"too fast for this machine: again, a sample each {1000 * period:g} ms")
                again = replace(own, folder=own.folder / f"again-{1000 * period:g}-ms")
                trial = _trial(again, ready, asked, image, wires, period, CASES)
            found.append(trial)
    title = f"{ready.controller.title} on {settings.process.title}"
    return HardwareInTheLoop(title, tuple(found), tuple(left_out))


def _fastest(
    settings: RigSettings, ready: Exportable, asked: Asked, image: ControllerImage, wires: str
) -> float:
    """Return the first period that is met for a while; the last one where none is."""
    for period in PERIODS[:-1]:
        folder = settings.folder / f"speed-{1000 * period:g}-ms"
        trial = _trial(
            replace(settings, folder=folder), ready, asked, image, wires, period, _IN_TIME
        )
        if trial.timing.is_met:
            return period
    return PERIODS[-1]


def _trial(
    settings: RigSettings,
    ready: Exportable,
    asked: Asked,
    image: ControllerImage,
    wires: str,
    period: float,
    cases: Mapping[str, Case],
) -> Tried:
    process = settings.process
    silence = max(_SILENT_PERIODS * period, _SILENT)
    plant = replace(settings.plant, silence=silence)
    settings = replace(settings, plant=plant, speed=process.sampling_period / period)
    door, wires_to = _DOORS[wires](settings, asked)
    at = ready.point.as_dict()
    level, pump = process.signal(process.controlled[0]), process.inputs[0]
    subject = Subject(
        process, replace(level, initial=at[level.name]), replace(pump, initial=at[pump.name]),
        plant.fail_safe, period, math.ceil(silence / period), SENSOR_DELAY.default,
    )  # fmt: skip
    return tried(replace(settings, doors=(door,)), ready, image, wires_to, subject, cases)


def _modbus(settings: RigSettings, asked: Asked) -> tuple[Door, Callable[[RunningRig], Wires]]:
    from clepsydra.rig.doors.modbus.door import ModbusDoor
    from clepsydra.rig.doors.modbus.encoding import Encoding
    from clepsydra.rig.doors.modbus.register_map import default_map

    registers = default_map(settings.tags, Encoding(asked.encoding))
    door = ModbusDoor(registers, port=_free_port())
    return door, lambda rig: modbus_wires(registers, door.host, door.port)


def _opc_ua(settings: RigSettings, asked: Asked) -> tuple[Door, Callable[[RunningRig], Wires]]:
    from clepsydra.rig.doors.opc_ua.client import access_to_rig
    from clepsydra.rig.doors.opc_ua.door import OpcUaDoor
    from clepsydra.rig.doors.opc_ua.identity import Identity

    certificates = settings.folder / "opc-ua"
    door = OpcUaDoor(certificates, settings.tags, port=_free_port())
    plc = Identity(settings.folder / "plc", "controller")

    def wires(rig: RunningRig) -> Wires:
        return opc_ua_wires(access_to_rig(door.address, certificates, plc), settings.tags)

    return door, wires


def _free_port() -> int:
    """Return a port of this machine that is free now."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


_DOORS = {"modbus": _modbus, "opc-ua": _opc_ua}
