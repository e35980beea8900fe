"""The plant of a rig and what its history keeps, from a process with a controller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from clepsydra.base.history_file import MOST_SIGNALS
from clepsydra.base.signal import Signal, path
from clepsydra.laboratory.rig import Rig
from clepsydra.process.process import Process
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.settings import RigSettings
from clepsydra.rig.tag import COMMAND, COMMAND_STATUS, HEARD, LATENESS, REMOTE
from clepsydra.rig.tags import tags_of

#: Without a sign of life for so many sampling periods, and at least this long, a controller is
#: silent [s].
_SILENT_PERIODS, _SILENT = 3.0, 1.0


def plant_settings(
    rig: Rig,
    *,
    speed: float,
    fail_safe: Mapping[str, float],
    silence: float | None = None,
    seed: int = 1,
    remote: bool = True,
) -> PlantSettings:
    """Return the plant of a laboratory's rig, whose first controller is that of its local panel.

    Parameters
    ----------
    speed : float
        Times as fast as real time.
    fail_safe : mapping
        Input to where it goes while the controller is silent [SI]; its low end if left out.
    silence : float, optional
        After so long without a sign of life a controller is silent [s]; after three sampling
        periods, at least 1 s, if left out.
    seed : int
        Of the noise.
    remote : bool
        Whether the wires move the plant at first, and not the controller of its local panel.
    """
    process, station = rig.point.process, rig.stations[0]
    safe = {u.name: fail_safe.get(u.name, u.low) for u in process.inputs}
    if silence is None:
        silence = max(_SILENT_PERIODS * process.sampling_period / speed, _SILENT)
    return PlantSettings(station, rig.noises, safe, silence, seed, remote)


def rig_settings(
    rig: Rig,
    folder: Path,
    *,
    speed: float,
    fail_safe: Mapping[str, float],
    silence: float | None = None,
    seed: int = 1,
    remote: bool = True,
) -> RigSettings:
    """Return a rig of a laboratory's, without doors; all as for `plant_settings`.

    Parameters
    ----------
    folder : Path
        Of its history, and of what it remembers.
    """
    process = rig.point.process
    plant = plant_settings(
        rig, speed=speed, fail_safe=fail_safe, silence=silence, seed=seed, remote=remote
    )
    kept = kept_signals(process, plant)
    tags = tags_of(rig.point)
    return RigSettings(process.title, plant, tags, process, (), folder, kept, speed)


def kept_signals(process: Process, settings: PlantSettings) -> tuple[Signal, ...]:
    """Return what a history keeps of a plant, what a reader asks for first in front.

    Of a plant with more signals than a file has columns the last ones are left out.
    """
    columns = set(settings.layout.columns)
    switch = Signal("switch", kind="boolean")

    def part(owner: Signal, name: str, words: str, of: Signal | None = None) -> Signal:
        return replace(of or owner, name=path(owner, name), description=words)

    controlled = [process.signal(name) for name in process.controlled]
    found = (
        *process.measurements,
        *process.inputs,
        *(part(y, "setpoint", f"setpoint of {y.name}") for y in controlled),
        *(part(u, "applied", f"where {u.name} stands") for u in process.inputs),
        *(part(u, "mode", f"mode of {u.name}", switch) for u in process.inputs),
        *(part(u, COMMAND, f"what the controller asks {u.name} for") for u in process.inputs),
        *(part(u, COMMAND_STATUS, f"status word of {u.name}", switch) for u in process.inputs),
        *process.disturbances,
        *process.state,
        *(part(y, "sensor", f"whether {y.name} can be believed", switch)
          for y in process.measurements),
        replace(switch, name=REMOTE, description="whether the wires move the plant"),
        replace(switch, name=HEARD, description="whether the controller on the wires is heard"),
        Signal(LATENESS, "s", display_unit="ms", description="by which a sample began too late"),
    )  # fmt: skip
    return tuple(each for each in found if each.name in columns)[:MOST_SIGNALS]
