"""What an engineer may set of the plant shell, by the names of the process signals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.parameters import is_finite_number
from clepsydra.controllers.signals import LARGEST_PARAMETER

#: Share of the sampling period by which a measured time step may differ from it.
SCAN_TOLERANCE = 0.1


@dataclass(frozen=True)
class PlantShell:
    """Settings of the plant shell; what is left out has the value that does nothing.

    Parameters
    ----------
    ranges : mapping
        Measurement to its values at 4 and at 20 mA [measurement unit]; that of its signal if
        left out.
    sensor_delay : mapping
        Measurement to how long a fault of it is ridden through [s]; 4 s if left out.
    setpoint_rate : mapping
        Controlled measurement to the largest rate of its setpoint [unit/s]; none if left out.
    rate_limit : mapping
        Manipulated variable to its largest rate [unit/s]; none if left out.
    fail_safe : mapping
        Manipulated variable to its value after a fault [unit]; its low limit if left out.
    scan_tolerance : float
        Share of the sampling period by which a time step may differ from it before the status
        word says so [1].

    Raises
    ------
    InputError
        A value is no number, or outside what is possible.

    Examples
    --------
    >>> PlantShell(sensor_delay={"level_1": 2.0}).sensor_delay["level_1"]
    2.0
    >>> PlantShell(setpoint_rate={"level_1": 0.0})
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: plant shell, setpoint_rate, level_1: got 0.0, expected a \
number above 0 and at most 1e+09; correct it, or leave it out.
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    sensor_delay: Mapping[str, float] = field(default_factory=dict)
    setpoint_rate: Mapping[str, float] = field(default_factory=dict)
    rate_limit: Mapping[str, float] = field(default_factory=dict)
    fail_safe: Mapping[str, float] = field(default_factory=dict)
    scan_tolerance: float = SCAN_TOLERANCE

    def __post_init__(self) -> None:
        for what in ("ranges", "sensor_delay", "setpoint_rate", "rate_limit", "fail_safe"):
            given = getattr(self, what)
            if not isinstance(given, Mapping):
                raise InputError(
                    f"plant shell, {what}", given, "values by the names of signals",
                    'write as in {"level_1": 2.0}',
                )  # fmt: skip
        for name, pair in self.ranges.items():
            _check_range(f"plant shell, ranges, {name}", pair)
        for name, delay in self.sensor_delay.items():
            _check(f"plant shell, sensor_delay, {name}", delay, _or_nan(delay) >= 0.0, "at or")
        for what in ("setpoint_rate", "rate_limit"):
            for name, rate in getattr(self, what).items():
                _check(f"plant shell, {what}, {name}", rate, _or_nan(rate) > 0.0, "")
        for name, value in self.fail_safe.items():
            if not is_finite_number(value):
                raise InputError(
                    f"plant shell, fail_safe, {name}", value, "a finite number", "correct it"
                )
        share = self.scan_tolerance
        if not 0.0 < _or_nan(share) <= 1.0:
            raise InputError(
                "plant shell, scan_tolerance", share, "a share above 0 and at most 1",
                "write 0.1 for a tenth of the sampling period",
            )  # fmt: skip


def check_names(
    what: str, given: Iterable[str], known: Iterable[str], place: str, kind: str
) -> None:
    """Refuse settings for a signal that a controller does not have.

    Parameters
    ----------
    what : str
        The setting.
    given, known : iterable of str
        Names of signals.
    place : str
        The controller's name, for the message.
    kind : str
        What the names stand for: "measurement".

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_names("ranges", ["level_7"], ["level_1"], "PI", "measurement")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: PI, plant shell, ranges: got 'level_7', expected a \
measurement of the controller: level_1; perhaps 'level_1' was meant.
    """
    names = list(dict.fromkeys(known))
    for name in given:
        if name not in names:
            raise InputError(
                f"{place}, plant shell, {what}", name,
                f"a {kind} of the controller: {', '.join(names) or 'it has none'}",
                suggestion(name, names, "correct the name or leave it out"),
            )  # fmt: skip


def _or_nan(value: object) -> float:
    return float(value) if is_finite_number(value) else float("nan")  # type: ignore[arg-type]


def _check(place: str, value: object, holds: bool, beside: str) -> None:
    if not (holds and _or_nan(value) <= LARGEST_PARAMETER):
        bound = f"{beside} above".strip()
        raise InputError(
            place, value, f"a number {bound} 0 and at most {LARGEST_PARAMETER:g}",
            "correct it, or leave it out",
        )  # fmt: skip


def _check_range(place: str, pair: object) -> None:
    proper = isinstance(pair, (tuple, list)) and len(pair) == 2
    ends = [_or_nan(end) for end in pair] if isinstance(pair, (tuple, list)) else []
    largest = LARGEST_PARAMETER
    if not proper or not -largest <= ends[0] < ends[1] <= largest:
        raise InputError(
            place, pair, "the values at 4 mA and at 20 mA, the first below the second",
            "write as in (0.0, 10.0)",
        )  # fmt: skip
