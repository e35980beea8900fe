"""Random scans: a plant that goes wrong in every way that the inputs of a program can express."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.deploy.proof.instance import Array
from clepsydra.program.program import Program

#: Fewest scans of a proof.
FEWEST = 10_000
#: A sensor's fault is held for so long before it counts, unless a plant says otherwise [s].
_FAULT_DELAY = 4.0
#: And is never longer than this many scans, so that sound operation remains.
_LONGEST_FAULT = 200
#: What a broken channel delivers.
_BROKEN = (math.nan, math.inf, -math.inf, 1e301, -1e301, -0.0, 5e-324)
#: Currents of a transmitter [mA]: 4 to 20 is the range of the signal; below 3.6 and above 21 it
#: reports a fault, and 3.6 to 3.8 and 20.5 to 21 are uncertain (NAMUR NE 43).
_CURRENTS = (3.5, 3.59, 3.61, 3.7, 3.79, 3.81, 20.49, 20.51, 20.7, 20.99, 21.01, 22.0)
#: What is forgotten stays for this share of all scans on average.
_LONG = 0.02
#: A rate of this size is none that limits.
_UNLIMITED = 1e9
_WRONG_STEPS = (0.0, -1.0, math.nan, math.inf, -math.inf, 1e301)
#: What an engineer types for a parameter by mistake; not a number stands for the printed value.
_WRONG_VALUES = (math.inf, -math.inf, 1e301, -1.0, 0.0)
#: Sampling periods after which a scan is lost.
_LATE_STEPS = (6.0, 60.0, 3600.0)
_UNEVEN_STEPS = (0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 2.0, 3.7)


def random_scans(
    program: Program, scans: int, seed: int, sampling_period: float, *, broken: bool = True
) -> dict[str, Array]:
    """Return random inputs and parameters of a program, by name [scans].

    Setpoints step within their range and stay there; measurements now follow them and now walk
    over their whole range, with noise; they leave it through the uncertain currents into the
    faulty ones for times below and above the delay of a fault, and are no numbers. Sensors fail,
    modes change, also to modes that there are not, values of manual and tracking walk beyond
    their limits, cold and warm starts and acknowledgements come at any time, while a sensor is
    bad too, and last for a scan or for many, and the time step is uneven, late or wrong. The block
    begins without kept state. What else is an input walks over its range. For half of the time
    somebody tunes: parameters change by up to a hundredth, rates without a limit get one, delays
    of sensors get others; now and then one is typed wrong for a scan. Not a number stands for the
    printed value of a parameter.

    Parameters
    ----------
    program : Program
    scans : int
    seed : int
        The same seed gives the same scans; an input depends on nothing but seed and name, and a
        start on the sensors.
    sampling_period : float
        [s]
    broken : bool
        Whether anything goes wrong or changes; without it all inputs stay in their ranges and
        there are no parameters, for the simulation of a process.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> program = Program("law", (), (Signal("pump.mode", low=0.0, high=2.0, kind="integer"),), (),
    ...                   (), Block(1, (), ()))
    >>> sorted(set(random_scans(program, 10_000, 1, 1.0)["pump.mode"].tolist()))
    [-1.0, 0.0, 1.0, 2.0, 3.0]
    """
    plant = _Plant(program, scans, seed, sampling_period, broken)
    found = {signal.name: plant.values(signal) for signal in program.inputs}
    if broken:
        found |= {signal.name: plant.tuned(signal) for signal in program.parameters}
    return found


class _Plant:
    def __init__(
        self, program: Program, scans: int, seed: int, period: float, broken: bool
    ) -> None:
        self._signals = {signal.name: signal for signal in program.inputs}
        self._scans, self._seed, self._period, self._broken = scans, seed, period, broken
        delay = math.ceil(_FAULT_DELAY / period)
        self._fault = max(1, min(delay, _LONGEST_FAULT // 3))
        self._long = 1.0 + _LONG * scans
        calendar = np.random.default_rng((seed, zlib.crc32(b"tuning")))
        self._tuning = self._held(calendar, 500.0, lambda n: calendar.uniform(size=n)) > 0.5

    def values(self, signal: Signal) -> Array:
        """Return the values of an input."""
        random = np.random.default_rng((self._seed, zlib.crc32(signal.name.encode())))
        made = self._maker(signal)(signal, random)
        if signal.kind != "real":
            return made
        with np.errstate(all="ignore"):
            return made.astype(float)

    def tuned(self, signal: Signal) -> Array:
        """Return the values of a parameter."""
        random = np.random.default_rng((self._seed, zlib.crc32(signal.name.encode())))
        value = signal.initial

        def draw(count: int) -> Array:
            if signal.kind != "real":
                low, high = max(signal.low, value - 2.0), min(signal.high, value + 2.0)
                return np.round(random.uniform(low, high, count))
            if abs(value) >= _UNLIMITED:
                return np.exp(random.uniform(math.log(1e-3), math.log(3.0), count))
            if signal.part == "sensor_delay":
                return value * random.choice([0.0, 0.5, 1.0, 1.7], count)
            return value * random.uniform(0.99, 1.01, count)

        values = np.clip(self._held(random, 250.0, draw), signal.low, signal.high)
        values = np.where(self._tuning, values, math.nan)
        if signal.kind == "real":
            wrong = random.random(self._scans) < 0.0005
            values[wrong] = random.choice(_WRONG_VALUES, int(wrong.sum()))
        return values

    def _maker(self, signal: Signal) -> Callable[[Signal, np.random.Generator], Array]:
        special = {
            "sp": self._setpoint,
            "pv": self._measurement,
            "good": self._sensor,
            "mode": self._mode,
            "time_step": self._time_step,
        }
        if signal.name == "start":
            return self._start
        if signal.kind == "boolean":
            return self._sensor if signal.part == "good" else self._pulses
        if signal.part in special and (signal.kind == "real" or signal.part == "mode"):
            return special[signal.part]
        return self._walk if signal.kind == "real" else self._choice

    def _range(self, signal: Signal) -> tuple[float, float]:
        low, high, size = signal.low, signal.high, max(1.0, abs(signal.initial))
        if not math.isfinite(low):
            low = (high if math.isfinite(high) else signal.initial) - size
        if not math.isfinite(high):
            high = max(low, signal.initial) + size
        return low, high

    def _held(
        self, random: np.random.Generator, mean: float, draw: Callable[[int], Array]
    ) -> Array:
        """Values that stay for some scans each, on average `mean`."""
        lengths = 1 + random.geometric(1.0 / mean, size=self._scans)
        count = int(np.searchsorted(np.cumsum(lengths), self._scans)) + 1
        return np.repeat(draw(count), lengths[:count])[: self._scans]

    def _setpoint(self, signal: Signal, random: np.random.Generator) -> Array:
        low, high = self._range(signal)
        values = self._held(random, 60.0, lambda n: random.uniform(low, high, n))
        if not self._broken:
            return values
        beyond = random.random(self._scans) < 0.005
        values[beyond] = random.uniform(2 * low - high, 2 * high - low, int(beyond.sum()))
        return self._spoilt(values, random, 0.003)

    def _measurement(self, signal: Signal, random: np.random.Generator) -> Array:
        low, high = self._range(signal)
        span = high - low
        values = self._reflected(random, low, high, 0.01 * span)
        target = self._signals.get(path(signal.owner, "sp"))
        if target is not None and (target.low, target.high) == (signal.low, signal.high):
            # Half of the time near the setpoint, as in a loop that does its work.
            near = self._held(random, 300.0, lambda n: random.uniform(size=n)) > 0.5
            values[near] = self.values(target)[near]
        values += random.normal(scale=0.003 * span, size=self._scans)
        if not self._broken:
            return np.clip(values, low, high)
        currents = [low + (current - 4.0) / 16.0 * span for current in _CURRENTS]
        for start, stop in self._disturbed(random, min(120.0, 30.0 + 20.0 * self._fault)):
            if random.random() < 0.2:
                values[start:stop] = random.choice(np.array(_BROKEN))
            else:
                values[start:stop] = random.choice(currents)
        return self._spoilt(values, random, 0.002)

    def _sensor(self, signal: Signal, random: np.random.Generator) -> Array:
        values = np.ones(self._scans)
        if self._broken:
            for start, stop in self._disturbed(random, 300.0):
                values[start:stop] = 0.0
        return values

    def _mode(self, signal: Signal, random: np.random.Generator) -> Array:
        low, high = self._range(signal)
        usual = np.arange(low, high + 1.0)
        every = np.array([low - 1.0, *usual, high + 1.0]) if self._broken else usual
        chance = np.where((every < low) | (every > high), 0.02, 0.12)
        chance[every == 1.0] = 1.0
        chance /= chance.sum()
        return self._held(random, 50.0, lambda n: random.choice(every, n, p=chance))

    def _choice(self, signal: Signal, random: np.random.Generator) -> Array:
        low, high = self._range(signal)
        first, last = math.ceil(low), min(math.floor(high), math.ceil(low) + 20)
        if self._broken:
            first, last = max(first - 1, -(2**31)), min(last + 1, 2**31 - 1)
        return self._held(
            random, 40.0, lambda n: random.integers(first, last, n, endpoint=True).astype(float)
        )

    def _start(self, signal: Signal, random: np.random.Generator) -> Array:
        """Starts of one scan, some while a sensor is bad, and some that nobody takes back."""
        low, high = self._range(signal)
        if self._broken:
            low, high = low - 1.0, high + 1.0

        starts = np.arange(low, high + 1.0)
        values = np.full(self._scans, signal.initial)
        if self._broken:  # nothing was kept before the first scan
            values[:1] = 1.0
        for value in np.repeat(starts[starts != signal.initial], 2):
            begin = int(random.integers(self._scans))
            values[begin : begin + int(random.uniform(0.5, 1.5) * self._long)] = value
        anywhere, bad = np.arange(self._scans), np.flatnonzero(self._bad_sensor())
        for scans, share in ((anywhere, 0.004), (bad, 0.006)):
            places = random.choice(scans, round(share * self._scans) if len(scans) else 0)
            values[places] = random.choice(starts, len(places))
        return values

    def _bad_sensor(self) -> Array:
        """Whether a measurement is no current of a sound transmitter, or a sensor reports so."""
        bad = np.zeros(self._scans, dtype=bool)
        if not self._broken:
            return bad
        for signal in self._signals.values():
            if signal.part == "good" and signal.kind == "boolean":
                bad |= self.values(signal) == 0.0
            elif signal.part == "pv" and signal.kind == "real":
                low, high = self._range(signal)
                with np.errstate(all="ignore"):
                    current = 4.0 + 16.0 * (self.values(signal) - low) / (high - low)
                    bad |= ~((current >= 3.6) & (current <= 21.0))
        return bad

    def _pulses(self, signal: Signal, random: np.random.Generator) -> Array:
        """Truth values that change often, and now and then not for long."""
        values = self._held(random, 20.0, lambda n: (random.random(n) < 0.3).astype(float))
        held = self._held(random, self._long, lambda n: random.random(n)) < 0.25
        values[held] = self._held(
            random, self._long, lambda n: (random.random(n) < 0.6).astype(float)
        )[held]
        return values

    def _time_step(self, signal: Signal, random: np.random.Generator) -> Array:
        values = np.full(self._scans, self._period)
        if not self._broken:
            return values
        uneven, wrong = random.random(self._scans) < 0.02, random.random(self._scans) < 0.006
        values[uneven] *= random.choice(_UNEVEN_STEPS, int(uneven.sum()))
        values[wrong] = random.choice(_WRONG_STEPS, int(wrong.sum()))
        late = random.random(self._scans) < 0.003
        values[late] = self._period * random.choice(_LATE_STEPS, int(late.sum()))
        return values

    def _walk(self, signal: Signal, random: np.random.Generator) -> Array:
        low, high = self._range(signal)
        span = high - low
        if not self._broken:
            return self._reflected(random, low, high, 0.02 * span)
        values = self._reflected(random, low - 0.1 * span, high + 0.1 * span, 0.02 * span)
        return self._spoilt(values, random, 0.005)

    def _reflected(
        self, random: np.random.Generator, low: float, high: float, step: float
    ) -> Array:
        """A random walk that turns round at both ends; now and then it jumps."""
        steps = random.normal(scale=step, size=self._scans)
        jumps = random.random(self._scans) < 0.01
        steps[jumps] = random.uniform(low - high, high - low, int(jumps.sum()))
        span = high - low
        if span <= 0.0:
            return np.full(self._scans, low)
        folded = np.abs((random.uniform(0.0, span) + np.cumsum(steps)) % (2.0 * span) - span)
        return low + folded

    def _disturbed(self, random: np.random.Generator, pause: float) -> list[tuple[int, int]]:
        """Stretches from one scan to three times the delay of a fault, some just at it."""
        found: list[tuple[int, int]] = []
        place = 0
        while True:
            place += 1 + int(random.exponential(pause))
            if place >= self._scans:
                return found
            length = round(math.exp(random.uniform(0.0, math.log(3.0 * self._fault))))
            if random.random() < 0.3:
                length = self._fault + int(random.integers(-1, 2))
            found.append((place, place + max(1, length)))
            place += max(1, length)

    def _spoilt(self, values: Array, random: np.random.Generator, share: float) -> Array:
        places = random.random(self._scans) < share
        values[places] = random.choice(np.array(_BROKEN), size=int(places.sum()))
        return values
