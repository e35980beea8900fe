"""What a rig is made of, all together."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.signal import Signal
from clepsydra.process.process import Process
from clepsydra.rig.doors.door import Door
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.retention import KEEP_ALL, Retention
from clepsydra.rig.script import Action
from clepsydra.rig.tag import Tag

#: What the history is called in the folder of a rig.
HISTORY = "history.sqlite"


@dataclass(frozen=True)
class RigSettings:
    """All that a rig is.

    Parameters
    ----------
    title : str
    plant : PlantSettings
    tags : tuple of Tag
    process : Process
        As its file has it.
    doors : tuple of Door
    folder : Path
        Where its history and what it remembers are; made where it is missing.
    kept : tuple of Signal
        What the history keeps.
    speed : float
        Times as fast as real time.
    retention : Retention
    resume : bool
        Whether it goes on where the last one in the folder stood.
    script : tuple of Action
        What is done at which time, in the order of the times.
    """

    title: str
    plant: PlantSettings
    tags: tuple[Tag, ...]
    process: Process
    doors: tuple[Door, ...]
    folder: Path
    kept: tuple[Signal, ...]
    speed: float = 1.0
    retention: Retention = KEEP_ALL
    resume: bool = False
    script: tuple[Action, ...] = ()
