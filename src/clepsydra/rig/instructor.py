"""What an instructor does to a rig: faults of sensors, final elements and wires, disturbances."""

from __future__ import annotations

import math
from typing import Literal, get_args

from clepsydra.base.arguments import require_known, require_signal
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.loop.faults import FORCED, READING, STICTION, STOPPED
from clepsydra.process.process import Process
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.tag import DRIFT, LATEST_ANSWER, NOISE, WIRE_CUT, WIRE_DELAY, WIRE_LOSS

SensorFault = Literal["none", "stuck", "drifting", "out of range", "dead"]
ActuatorFault = Literal["none", "stopped", "sticking", "stuck"]
#: A sensor drifts by a tenth of its range in so many samples; beyond its end it shows so much more.
_DRIFT_PER_SAMPLE, _BEYOND = 0.1 / 1000, 0.05
#: What sticks has to be asked to go further than this share of its range; what is stuck, further
#: than that.
_STICKING, _STUCK = 0.05, 2.0


def faults_of(process: Process) -> dict[str, tuple[str, ...]]:
    """Return what can fail, measurements and inputs, and how.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> faults_of(load_process("three-tanks"))["level_1"]
    ('none', 'stuck', 'drifting', 'out of range', 'dead')
    """
    sensors = {y.name: get_args(SensorFault) for y in process.measurements}
    return sensors | {u.name: get_args(ActuatorFault) for u in process.inputs}


class Instructor:
    """The faults of a rig, as they are in its process image and in the laboratory's page.

    Parameters
    ----------
    process : Process
    image : ProcessImage
    """

    def __init__(self, process: Process, image: ProcessImage) -> None:
        self._process, self._image = process, image

    def fail(self, name: str, fault: str) -> None:
        """Let a measurement or an input fail from the next sample on; "none" ends it.

        Raises
        ------
        InputError
            There is no such measurement or input, or it has no such fault.
        """
        known = faults_of(self._process)
        require_known("rig, fault", name, [*known])
        require_known(f"rig, fault, {name}", fault, [*known[name]])
        measured = {y.name: y for y in self._process.measurements}
        if name in measured:
            self._fail_sensor(measured[name], fault)
        else:
            self._fail_actuator(self._process.signal(name), fault)

    def _fail_sensor(self, signal: Signal, fault: str) -> None:
        image, name = self._image, signal.name
        now = image.read(name)
        low, span = _range(signal, now)
        shown = {"stuck": now, "out of range": low + (1.0 + _BEYOND) * span, "dead": low}
        if fault in shown:
            image.write(path(name, READING), shown[fault])
        image.write(path(name, FORCED), float(fault in shown))
        image.write(path(name, "sensor"), float(fault != "dead"))
        rate = _DRIFT_PER_SAMPLE * span / self._process.sampling_period
        image.write(path(name, DRIFT), rate if fault == "drifting" else 0.0)

    def _fail_actuator(self, signal: Signal, fault: str) -> None:
        _, span = _range(signal, 0.0)
        band = {"sticking": _STICKING * span, "stuck": _STUCK * span}.get(fault, 0.0)
        self._image.write(path(signal.name, STOPPED), float(fault == "stopped"))
        self._image.write(path(signal.name, STICTION), band)

    def disturb(self, name: str, value: float) -> None:
        """Give a disturbance another value [SI].

        Raises
        ------
        InputError
            There is no such disturbance.
        """
        require_signal("rig, disturbance", name, self._process.disturbances, "a disturbance")
        if not math.isfinite(value):
            raise InputError("rig, disturbance", value, "a finite number", "give another one")
        self._image.write(name, value)

    def noise(self, is_on: bool) -> None:
        """Let sensors and disturbances be noisy, or not."""
        self._image.write(NOISE, float(is_on))

    def wires(
        self, *, delay: float | None = None, loss: float | None = None, cut: bool | None = None
    ) -> None:
        """Let the wires of all doors be slow, lossy or pulled; what is left out stays as it is.

        Parameters
        ----------
        delay : float, optional
            By which answers are sent later [s].
        loss : float, optional
            Share of requests that nobody answers [1].
        cut : bool, optional
            Whether the cable is pulled.

        Raises
        ------
        InputError
            A time is not from 0 to 60 s, or a share not from 0 to 1.
        """
        given = {}
        if delay is not None:
            given[WIRE_DELAY] = check_delay(delay)
        if loss is not None:
            given[WIRE_LOSS] = check_loss(loss)
        if cut is not None:
            given[WIRE_CUT] = float(cut)
        for name, value in given.items():
            self._image.write(name, value)


def check_delay(delay: float, place: str = "rig, wires, delay") -> float:
    """Return by how much later answers come [s], or refuse it."""
    if not 0.0 <= delay <= LATEST_ANSWER:
        expected = f"a time from 0 to {LATEST_ANSWER:g} s"
        raise InputError(place, f"{delay:g} s", expected, 'write as in delay = "0.2 s"')
    return delay


def check_loss(loss: float, place: str = "rig, wires, loss") -> float:
    """Return the share of requests that are lost, or refuse it."""
    if not 0.0 <= loss <= 1.0:
        expected = "a share from 0 to 100 %"
        raise InputError(place, f"{100.0 * loss:g} %", expected, 'write as in loss = "10 %"')
    return loss


def _range(signal: Signal, value: float) -> tuple[float, float]:
    """Return where a range begins and how long it is; of an open one, as the value has it."""
    low = signal.low if math.isfinite(signal.low) else 0.0
    return low, signal.high - low if math.isfinite(signal.high) else max(abs(value - low), 1.0)
