"""An alarm on a measurement, in the words of ISA-18.2: what it watches for, and how it is timed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from typing import NamedTuple

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text


class Priority(IntEnum):
    """How soon an operator has to act: ISA-18.2, section 3.1."""

    LOW = 1
    MEDIUM = 2
    HIGH = 3

    @property
    def words(self) -> str:
        """As a file has it."""
        return self.name.lower()


class _Kind(NamedTuple):
    key: str
    short: str
    words: str
    priority: Priority


class AlarmKind(Enum):
    """What an alarm watches for.

    Examples
    --------
    >>> AlarmKind.HIGH_HIGH.key, AlarmKind.HIGH_HIGH.short, AlarmKind.RATE.words
    ('high_high', 'HH', 'rate-of-change alarm')
    """

    HIGH_HIGH = _Kind("high_high", "HH", "high-high alarm", Priority.HIGH)
    HIGH = _Kind("high", "H", "high alarm", Priority.MEDIUM)
    LOW = _Kind("low", "L", "low alarm", Priority.MEDIUM)
    LOW_LOW = _Kind("low_low", "LL", "low-low alarm", Priority.HIGH)
    DEVIATION = _Kind("deviation", "DEV", "deviation alarm", Priority.LOW)
    RATE = _Kind("rate", "ROC", "rate-of-change alarm", Priority.LOW)
    FLATLINE = _Kind("flatline", "FLAT", "flatline alarm", Priority.LOW)

    @property
    def key(self) -> str:
        """Its key in a process file, and its part of a path."""
        return self.value.key

    @property
    def short(self) -> str:
        """What an operator calls it."""
        return self.value.short

    @property
    def words(self) -> str:
        """Its name in ISA-18.2; what it calls an instrument diagnostic alarm is a flatline here."""
        return self.value.words

    @property
    def priority(self) -> Priority:
        """That of an alarm of which a file does not say it."""
        return self.value.priority

    @property
    def outermost(self) -> bool:
        """Whether nothing is left behind it but a trip."""
        return self in (AlarmKind.HIGH_HIGH, AlarmKind.LOW_LOW)


#: Those on the measurement itself, from the highest limit to the lowest.
LIMITS = (AlarmKind.HIGH_HIGH, AlarmKind.HIGH, AlarmKind.LOW, AlarmKind.LOW_LOW)


@dataclass(frozen=True)
class Alarm:
    """One alarm on one measurement.

    Parameters
    ----------
    measurement : str
    kind : AlarmKind
    limit : float
        Alarm limit [unit of the measurement, of a rate that per s]; of a flatline by how much the
        measurement may move and still counts as stuck.
    deadband : float
        How far it comes back before the alarm returns to normal [the same].
    on_delay, off_delay : float
        For how long the condition must be there before the alarm comes, and gone before it
        returns [s]; of a flatline the first is the time for which the transmitter is stuck.
    priority : Priority
    acknowledged : bool
        Whether an operator acknowledges it, so that it has the states of ISA-18.2.
    interlock : mapping
        Input to the value at which the alarm holds it [unit of the input].
    filter_time : float
        Of a rate [s].
    moves : mapping
        Of a flatline: input to by how much it has to move for the measurement to follow [its unit].

    Examples
    --------
    >>> alarm = Alarm("level_1", AlarmKind.HIGH, 8.0)
    >>> alarm.name, alarm.words(Signal("level_1", "V"))
    ('level_1.high', 'high alarm of level_1 at 8 V')
    """

    measurement: str
    kind: AlarmKind
    limit: float
    deadband: float = 0.0
    on_delay: float = 0.0
    off_delay: float = 0.0
    priority: Priority = Priority.MEDIUM
    acknowledged: bool = False
    interlock: Mapping[str, float] = field(default_factory=dict)
    filter_time: float = 0.0
    moves: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its path: the measurement, and what it watches for."""
        return f"{self.measurement}.{self.kind.key}"

    def met_by(self, value: float) -> bool:
        """Return whether a measurement that stays at a value is at a limit of its own or beyond.

        >>> Alarm("level_1", AlarmKind.LOW, 2.0).met_by(1.5)
        True
        """
        if self.kind in (AlarmKind.HIGH_HIGH, AlarmKind.HIGH):
            return value >= self.limit
        return self.kind in (AlarmKind.LOW, AlarmKind.LOW_LOW) and value <= self.limit

    def words(self, signal: Signal) -> str:
        """Return its name with its limit, in the unit in which the measurement is shown."""
        if self.kind is AlarmKind.FLATLINE:
            return f"{self.kind.words} of {self.measurement} after {self.on_delay:g} s"
        rate = "/s" if self.kind is AlarmKind.RATE else ""
        at = from_si(self.limit, signal.unit, signal.shown_unit)
        unit = f"{unit_text(signal.shown_unit)}{rate}"
        return f"{self.kind.words} of {self.measurement} at {at:.4g} {unit}".rstrip()


def interlocks(alarms: tuple[Alarm, ...]) -> dict[str, float]:
    """Return the inputs that some alarm holds to the value at which it does [unit of the input]."""
    return {name: value for alarm in alarms for name, value in alarm.interlock.items()}
