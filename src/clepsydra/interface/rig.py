"""`cl.run_rig`: a process in real time, on the wires of a plant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.interface.controller import AnyController
from clepsydra.interface.first_design import first_design
from clepsydra.interface.lab import rig_of
from clepsydra.interface.quantities import Quantity, read_time, read_values
from clepsydra.interface.rig_doors import INSTALLED, Doors
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.rig.running import RunningRig as RunningRig
    from clepsydra.rig.script import Action
    from clepsydra.rig.settings import RigSettings

#: Speeds that make sense: of a slow plant hours pass in a second.
_SLOWEST, _FASTEST = 0.01, 10_000.0
#: A plant cannot be moved more often, whatever its speed [s].
_SHORTEST_PERIOD = 0.001


@keywords_checked()
def run_rig(
    plant: Subject,
    controller: AnyController | None = None,
    *,
    speed: float = 1.0,
    doors: Doors = INSTALLED,
    folder: str | Path | None = None,
    fail_safe: Mapping[str, Quantity] | None = None,
    silence: Quantity | None = None,
    keep: Quantity | None = None,
    local: bool = False,
    resume: bool = False,
    script: str | Path | None = None,
    seed: int = 1,
) -> RunningRig:
    """Run a process in real time, for controllers on its wires.

    Parameters
    ----------
    plant : Plant, str or Path
    controller : Controller, optional
        Of its local panel; PI controllers by SIMC, or the first design that applies.
    speed : float
        Times as fast as real time.
    doors : Doors
        On this machine alone, those that are installed, if left out.
    folder : str or Path, optional
        Of its history, and of what it remembers; clepsydra-rig/NAME if left out.
    fail_safe : mapping, optional
        Input to where it goes while the controller is silent; its low end if left out.
    silence : optional
        After so long without a sign of life a controller is silent [s]; three sampling periods,
        at least 1 s, if left out.
    keep : optional
        For how long samples are kept in the history, or how large it gets, as in "7 d" or
        "500 MB"; all if left out.
    local : bool
        Whether its local panel moves it at first, and not the wires.
    resume : bool
        Whether it goes on where the last one in the folder stood.
    script : str or Path, optional
        Of a file that says which faults, setpoints and disturbances come when.
    seed : int
        Of the noise of its sensors, which is off at first.

    Returns
    -------
    RunningRig
        A context, in which it is at work: `table` has its tags.

    Raises
    ------
    InputError
        The machine cannot hold the speed, the folder is another rig's, or a door cannot open.

    Examples
    --------
    >>> import tempfile
    >>> import clepsydra as cl
    >>> if __name__ == "__main__":
    ...     with tempfile.TemporaryDirectory() as folder, cl.run_rig("quadruple-tank",
    ...                                                          folder=folder) as running:
    ...         running.table.read(running.table.tags["level_1.pv"]).good
    """
    from clepsydra.rig.assembly import rig_settings
    from clepsydra.rig.retention import KEEP_ALL, read_retention
    from clepsydra.rig.running import RunningRig

    own = plant_of(plant)
    check_speed(speed, own.process.sampling_period)
    bench = rig_of(own, controller or first_design(own))
    process = bench.point.process
    place = Path("clepsydra-rig", process.file_stem) if folder is None else Path(folder)
    settings = rig_settings(
        bench, place, speed=speed, fail_safe=_fail_safe(fail_safe or {}, process), seed=seed,
        silence=_silence(silence, process.sampling_period / speed), remote=not local,
    )  # fmt: skip
    settings = replace(
        settings,
        retention=KEEP_ALL if keep is None else read_retention(keep),
        resume=resume,
        script=() if script is None else _script(Path(script), settings),
    )
    # The page is written for its door: the last that can be wrong.
    return RunningRig(replace(settings, doors=doors.made(bench, settings)))


def _script(path: Path, settings: RigSettings) -> tuple[Action, ...]:
    from clepsydra.rig.script import read_script

    return tuple(read_script(path, settings.process, settings.tags))


def _fail_safe(given: Mapping[str, Quantity], process: Process) -> dict[str, float]:
    """Return where inputs go while the controller is silent, each within its range [SI]."""
    found = read_values("rig, fail_safe", given, process.inputs, "an input")
    for name, value in found.items():
        signal = process.signal(name)
        if not signal.low <= value <= signal.high:
            shown = at_port(signal)
            raise InputError(
                "rig, fail_safe", str(given[name]),
                f"a value of {name} from {shown.low:g} to {shown.high:g} {unit_text(shown.unit)}",
                "choose one within its range",
            )  # fmt: skip
    return found


def _silence(given: Quantity | None, sample: float) -> float | None:
    """Return after how long a controller is silent [s], at least a sample."""
    if given is None:
        return None
    found = read_time("rig", "silence", given)
    if found < sample:
        raise InputError(
            "rig, silence", str(given), f"at least a sample, {time_text(sample)} here",
            "give a longer one: a controller answers once a sample",
        )  # fmt: skip
    return found


def check_speed(speed: float, period: float) -> None:
    """Refuse a speed that no rig has, for a sampling period [s]."""
    if not _SLOWEST <= speed <= _FASTEST:
        expected = f"times as fast as real time, from {_SLOWEST:g} to {_FASTEST:g}"
        raise InputError("rig, speed", speed, expected, "choose another one")
    if period / speed < _SHORTEST_PERIOD:
        raise InputError(
            "rig, speed", speed, f"a speed at which a sample of {period:g} s takes at least "
            f"{1000 * _SHORTEST_PERIOD:g} ms", f"take {period / _SHORTEST_PERIOD:g} or less",
        )  # fmt: skip
