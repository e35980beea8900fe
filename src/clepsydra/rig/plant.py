"""The plant of a rig: a process that is moved sample by sample by what is on its wires."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.status import Mode
from clepsydra.deploy.printing.heading import digest
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.stepping import Snapshot, SteppedKernel
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.engine.white_noise import stream_of, white_noise
from clepsydra.laboratory.rig import Station
from clepsydra.loop.alarms import acknowledging_inputs
from clepsydra.rig.image import ImageLayout, ProcessImage, Published
from clepsydra.rig.tag import (
    ACKNOWLEDGE,
    COMMAND,
    COMMAND_STATUS,
    DRIFT,
    HEARD,
    HEARTBEAT,
    LATENESS,
    MISSED,
    NOISE,
    PLANT_WATCHDOG,
    REMOTE,
    WIRE_CUT,
    WIRE_DELAY,
    WIRE_LOSS,
)
from clepsydra.rig.tag_table import WRITES

#: Of the 16 bits of a counter.
_WORD = 1 << 16
#: Samples of noise that are made at a time.
_NOISE_AT_A_TIME = 1024


@dataclass(frozen=True)
class PlantSettings:
    """What a rig's plant is made of; it travels to the process that runs it.

    Parameters
    ----------
    station : Station
        The process with the controller of its local panel.
    noises : mapping
        Measurement or disturbance to the standard deviation of its noise [SI].
    fail_safe : mapping
        Input to where it goes while the controller on the wires is silent [SI].
    silence : float
        After so long without a sign of life the controller is silent [s].
    seed : int
        Of the noise.
    remote : bool
        Whether the wires move it at first.
    """

    station: Station
    noises: Mapping[str, float]
    fail_safe: Mapping[str, float]
    silence: float
    seed: int = 1
    remote: bool = True

    @cached_property
    def layout(self) -> ImageLayout:
        """Of the image through which it is moved."""
        program, process = self.station.program, self.station.loop.process
        inputs = [signal.name for signal in program.inputs]
        return ImageLayout(
            (
                *(signal.name for signal in program.outputs),
                PLANT_WATCHDOG,
                *(HEARD, LATENESS, MISSED),
            ),
            (
                *inputs,
                *(path(u, part) for part in (COMMAND, COMMAND_STATUS) for u in process.inputs),
                *(path(y, DRIFT) for y in process.measurements),
                *(HEARTBEAT, WRITES, ACKNOWLEDGE, REMOTE, NOISE, WIRE_DELAY, WIRE_LOSS, WIRE_CUT),
            ),
            len(program.state)
            + sum(ring.length for ring, _ in rings_and_turns(program))
            + len(process.measurements),
            digest(program),
        )

    @property
    def at_rest(self) -> dict[str, float]:
        """What moves it at first: everything at rest, in automatic, on its local panel or not."""
        process, own = self.station.loop.process, self.station.numbers
        commands = {path(u, COMMAND): own.at_rest[path(u, "manual")] for u in process.inputs}
        return {**own.at_rest, **commands, REMOTE: float(self.remote)}


class RigPlant:
    """The plant, wherever it stands.

    Parameters
    ----------
    settings : PlantSettings
    image : ProcessImage
        Of their layout. What was remembered in it is where the plant goes on; otherwise it begins
        at rest, and everything that moves it too.

    Attributes
    ----------
    sample : int
        The one that it goes through next.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import clepsydra as cl
    >>> from clepsydra.laboratory.rig import Rig
    >>> tanks = cl.load("quadruple-tank")
    >>> station = Rig(tanks.linear, [cl.design.simc(tanks)]).stations[0]
    >>> settings = PlantSettings(station, {}, {"pump_1": 0.0, "pump_2": 0.0}, silence=3.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     image = ProcessImage(Path(folder) / "image", settings.layout, new=True)
    ...     plant = RigPlant(settings, image)
    ...     plant.tell(0.0)
    ...     image.write("pump_1.command", 4.0)
    ...     plant.step(heard=True, time=1.0)
    ...     after = image.read("level_1")
    >>> plant.sample, round(after, 4)
    (1, 6.1728)
    """

    def __init__(self, settings: PlantSettings, image: ProcessImage) -> None:
        self.settings, self.image = settings, image
        station, process = settings.station, settings.station.loop.process
        self._inputs = [signal.name for signal in station.program.inputs]
        self._measured = [signal.name for signal in process.measurements]
        self._moved = [signal.name for signal in process.inputs]
        self._answers = [signal.name for signal in acknowledging_inputs(process)]
        self._places = {name: place for place, name in enumerate(image.layout.written)}
        self._noise: dict[str, np.ndarray] = {}
        self._drifted = np.zeros(len(self._measured))
        self.sample, self.heard, self._time = 0, True, 0.0
        self._lateness, self._missed = 0.0, 0
        start = station.numbers.starts["rest"]
        self._kernel = SteppedKernel(
            Kernel(station.program, fuse=False), inputs=station.numbers.at_rest,
            parameters=station.numbers.parameters, state=start.state, rings=start.rings,
        )  # fmt: skip
        found = image.remembered()
        if found is None:
            for name, value in settings.at_rest.items():
                image.write(name, value)
        else:
            self._go_on(*found)

    def _go_on(self, sample: int, numbers: np.ndarray) -> None:
        here = self._kernel.snapshot()
        states, held = here.state.size, here.rings.size
        self._kernel.restore(
            Snapshot(
                numbers[:states].reshape(here.state.shape),
                numbers[states : states + held].reshape(here.rings.shape),
            )
        )
        self._drifted = numbers[states + held :].copy()
        self.sample = sample

    def tell(self, time: float) -> None:
        """Publish what the plant shows before its next sample, and remember where it stands."""
        written = self.image.written()
        told = self._told(self._kernel.look(self._given(written)), written)
        here = self._kernel.snapshot()
        numbers = np.concatenate([here.state.ravel(), here.rings.ravel(), self._drifted])
        self.image.remember(self.sample, numbers)
        self.image.publish(self.sample, time, told)
        self._time = time

    def step(self, *, heard: bool, time: float, lateness: float = 0.0, missed: int = 0) -> None:
        """Go through a sample with what is on the wires, and tell what the plant shows then.

        Parameters
        ----------
        heard : bool
            Whether the controller on the wires has given a sign of life in time.
        time : float
            [s since 1970]
        lateness : float
            By which it begins behind its deadline [s].
        missed : int
            Periods that were left out so far.
        """
        self.heard = heard
        written = self.image.written()
        told = self._told(self._kernel.step(self._given(written)), written)
        self.image.keep(Published(self.sample, self._time, told), written)
        period = self.settings.station.loop.process.sampling_period
        for place, name in enumerate(self._measured):
            rate = written[self._places[path(name, DRIFT)]]
            # Without a drift a sensor is put right at once.
            self._drifted[place] = self._drifted[place] + rate * period if rate else 0.0
        self.sample += 1
        self._lateness, self._missed = lateness, missed
        self.tell(time)

    def _given(self, written: np.ndarray) -> dict[str, float]:
        given = {name: float(written[self._places[name]]) for name in self._inputs}
        if written[self._places[REMOTE]]:
            for name in self._moved:
                command = float(written[self._places[path(name, COMMAND)]])
                safe = self.settings.fail_safe[name]
                given[path(name, "mode")] = float(Mode.MANUAL)
                given[path(name, "manual")] = command if self.heard else safe
        if written[self._places[ACKNOWLEDGE]]:
            given |= dict.fromkeys(self._answers, 1.0)
        for place, name in enumerate(self._measured):
            given[path(name, "noise")] += float(self._drifted[place])
        if written[self._places[NOISE]]:
            for name, deviation in self.settings.noises.items():
                enters = path(name, "noise") if name in self._measured else name
                given[enters] += deviation * self._white(name)
        return given

    def _white(self, name: str) -> float:
        first = self.sample - self.sample % _NOISE_AT_A_TIME
        if self.sample == first or name not in self._noise:
            stream = stream_of(name)
            self._noise[name] = white_noise(self.settings.seed, stream, first, _NOISE_AT_A_TIME)
        return float(self._noise[name][self.sample - first])

    def _told(self, found: dict[str, float], written: np.ndarray) -> np.ndarray:
        """Return what is published: what the program found, and what the plant says of itself."""
        if written[self._places[REMOTE]]:
            # Its own controller follows in manual; the one on the wires judges itself.
            found |= {
                path(name, "status"): written[self._places[path(name, COMMAND_STATUS)]]
                for name in self._moved
                if path(name, "status") in found
            }
        own = (self.sample % _WORD, float(self.heard), self._lateness, float(self._missed))
        return np.array([*found.values(), *own])
