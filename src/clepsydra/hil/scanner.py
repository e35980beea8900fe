"""One scan of a soft PLC: inputs from the bus, the controller, outputs to the bus."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.hil.controller_image import ControllerImage, LoadedController
from clepsydra.rig.bus import Bus, BusFault
from clepsydra.rig.tag import PLANT_WATCHDOG

#: Of a counter of 16 bits.
_WORD = 1 << 16


@dataclass(frozen=True)
class Wiring:
    """Which tags a controller reads and writes.

    Parameters
    ----------
    reads : mapping
        Input of the program to the name of the tag that it takes.
    writes : mapping
        Output of the program to the name of the tag that gets it.
    quality : frozenset of str
        Inputs that say of a sensor that it can be believed: none can while the bus fails.
    """

    reads: Mapping[str, str]
    writes: Mapping[str, str]
    quality: frozenset[str] = field(default_factory=frozenset)


@dataclass(frozen=True)
class Scan:
    """What a scan read and wrote.

    Parameters
    ----------
    sample : int
        Of the plant, as its watchdog counts, unwrapped; −1 before it was read once.
    read, written : str
        Why inputs, or outputs, did not get through; empty where they did.
    given, found : tuple of float
        All inputs and outputs of the program, in their units.
    """

    sample: int
    read: str
    written: str
    given: tuple[float, ...]
    found: tuple[float, ...]


class Scanner:
    """Runs a controller on a bus, scan by scan.

    Where the bus does not let inputs through the controller scans all the same, as a PLC does: with
    the last values, of which none can be believed.

    Parameters
    ----------
    image : ControllerImage
    wiring : Wiring
    bus : Bus
        Open.
    """

    def __init__(self, image: ControllerImage, wiring: Wiring, bus: Bus) -> None:
        self.controller, self._wiring, self._bus = LoadedController(image), wiring, bus
        self._tags = (*dict.fromkeys(wiring.reads.values()), PLANT_WATCHDOG)
        self.sample = -1

    async def look(self) -> int:
        """Return which sample the plant has told last, unwrapped.

        Raises
        ------
        BusFault
        """
        self._count((await self._bus.read([PLANT_WATCHDOG]))[PLANT_WATCHDOG])
        return self.sample

    async def scan(self, time_step: float, start: int) -> Scan:
        """Go through one scan.

        Parameters
        ----------
        time_step : float
            Since the last one [s].
        start : int
            1 for a warm start and 2 for a cold one; 0 to run on.
        """
        given: dict[str, float] = {"time_step": time_step, "start": float(start)}
        read = written = ""
        try:
            values = await self._bus.read(self._tags)
        except BusFault as fault:
            read = str(fault)
            given |= dict.fromkeys(self._wiring.quality, 0.0)
        else:
            self._count(values[PLANT_WATCHDOG])
            given |= {port: values[tag] for port, tag in self._wiring.reads.items()}
        found = self.controller.scan(given)
        try:
            await self._bus.write({tag: found[port] for port, tag in self._wiring.writes.items()})
        except BusFault as fault:
            written = str(fault)
        return Scan(self.sample, read, written, self.controller.given, tuple(found.values()))

    def _count(self, watchdog: float) -> None:
        if self.sample < 0:
            self.sample = int(watchdog)
        self.sample += (int(watchdog) - self.sample) % _WORD
