"""What linguistic variables stand for in a process."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals

Quantity = Literal["error", "error_rate", "measurement", "measurement_rate"]
Action = Literal["position", "increment"]

_LARGEST = signals.LARGEST_PARAMETER
_GAIN = signals.signed("gain", "1/{crisp}", "gain of {crisp}", 1.0)
_DEAD_ZONE = Key("dead_zone", "{crisp}", "half width of the dead zone of {crisp}", 0.0, _LARGEST)
_FILTER_TIME = Key("filter_time", "s", "time constant of the filter of {crisp}", 0.0, _LARGEST)
_OUTPUT_GAIN = signals.signed("output_gain", "{crisp}", "gain to {crisp}", 1.0)
_FADING_TIME = Key(
    "fading_time", "s", "time in which a bumpless start of {crisp} fades",
    signals.SHORTEST_TIME, _LARGEST, 60.0,
)  # fmt: skip


@dataclass(frozen=True)
class FuzzyInput:
    """What a linguistic input stands for.

    Parameters
    ----------
    quantity : {"error", "error_rate", "measurement", "measurement_rate"}
        The error is setpoint less measurement; a rate is a filtered derivative.
    measurement : str

    Examples
    --------
    >>> FuzzyInput("error_rate", "level").is_rate
    True
    """

    quantity: Quantity
    measurement: str

    @property
    def is_rate(self) -> bool:
        """Whether it is a derivative."""
        return self.quantity.endswith("_rate")

    @property
    def is_of_error(self) -> bool:
        """Whether it needs a setpoint."""
        return self.quantity.startswith("error")

    def crisp(self, name: str, measured: Signal) -> Signal:
        """Return what the linguistic variable of a name stands for, in its units."""
        units = signals.per(measured, "s") if self.is_rate else measured
        words = f"{name}, {self.quantity.replace('_', ' ')} of {self.measurement}"
        return Signal(words, units.unit, units.display_unit)

    def parameters(self, name: str, measured: Signal) -> list[Signal]:
        """Return gain, dead_zone and, of a rate, filter_time of a linguistic variable."""
        keys = (_GAIN, _DEAD_ZONE, *([_FILTER_TIME] if self.is_rate else []))
        return [key.of(name, crisp=self.crisp(name, measured)) for key in keys]

    def state(self, name: str, measured: Signal) -> list[Signal]:
        """Return filtered, of a rate."""
        words = f"filtered {self.quantity.removesuffix('_rate')} behind {name}"
        kept = Signal(path(name, "filtered"), measured.unit, description=words)
        return [kept] if self.is_rate else []


@dataclass(frozen=True)
class FuzzyOutput:
    """What a linguistic output does to its manipulated variable.

    Parameters
    ----------
    action : {"position", "increment"}
        The centroid is where the manipulated variable goes, or how fast it moves.
    rate_limited : bool

    Examples
    --------
    >>> FuzzyOutput().action
    'position'
    """

    action: Action = "position"
    rate_limited: bool = False

    @property
    def is_position(self) -> bool:
        """Whether it is where the manipulated variable goes."""
        return self.action == "position"

    def crisp(self, moved: Signal) -> Signal:
        """Return what the centroid of a gain of one is, in its units."""
        units = moved if self.is_position else signals.per(moved, "s")
        return replace(units, name=moved.name)

    def parameters(self, moved: Signal) -> list[Signal]:
        """Return output_gain, fading_time of a position, limits and rate_limit."""
        keys = (_OUTPUT_GAIN, *([_FADING_TIME] if self.is_position else []))
        found = [key.of(moved, crisp=self.crisp(moved)) for key in keys]
        found += signals.limit_parameters(moved)
        if self.rate_limited:
            words = f"largest rate of change of {moved.name}"
            found.append(signals.largest_rate(path(moved, "rate_limit"), moved, words))
        return found

    def state(self, moved: Signal) -> list[Signal]:
        """Return offset, of a position."""
        words = f"what a bumpless start adds to {moved.name}"
        offset = Signal(path(moved, "offset"), moved.unit, description=words)
        return [offset] if self.is_position else []
