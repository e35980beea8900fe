"""What an engineer may set of the plant shell, by the names of the process signals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER

#: Share of the sampling period by which a measured time step may differ from it.
SCAN_TOLERANCE = 0.1


def _is_range(pair: Any) -> bool:
    proper = isinstance(pair, (tuple, list)) and len(pair) == 2
    proper = proper and all(map(is_finite_number, pair))
    return proper and -LARGEST_PARAMETER <= pair[0] < pair[1] <= LARGEST_PARAMETER


def _is_rate(value: Any) -> bool:
    return is_finite_number(value) and 0.0 < value <= LARGEST_PARAMETER


_RANGE = "the values at 4 mA and at 20 mA, the first below the second, as in (0.0, 10.0)"
_LARGEST = f"0 and at most {LARGEST_PARAMETER:g}"
#: Of which signals of a controller a setting is, what it may be, and how that is told.
_SETTINGS: dict[str, tuple[str, Callable[[Any], bool], str]] = {
    "ranges": ("measurements", _is_range, _RANGE),
    "sensor_delay": (
        "measurements",
        lambda value: is_finite_number(value) and 0.0 <= value <= LARGEST_PARAMETER,
        f"a number at or above {_LARGEST}",
    ),
    "setpoint_rate": ("setpoints", _is_rate, f"a number above {_LARGEST}"),
    "rate_limit": ("manipulated", _is_rate, f"a number above {_LARGEST}"),
    "fail_safe": ("manipulated", is_finite_number, "a finite number"),
}  # fmt: skip
_KINDS = {
    "measurements": "measurement",
    "setpoints": "controlled measurement",
    "manipulated": "manipulated variable",
}


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

    Raises InputError: A value is no number, or outside what is possible.
    """

    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    sensor_delay: Mapping[str, float] = field(default_factory=dict)
    setpoint_rate: Mapping[str, float] = field(default_factory=dict)
    rate_limit: Mapping[str, float] = field(default_factory=dict)
    fail_safe: Mapping[str, float] = field(default_factory=dict)
    scan_tolerance: float = SCAN_TOLERANCE

    def __post_init__(self) -> None:
        for what, (_, holds, expected) in _SETTINGS.items():
            given = getattr(self, what)
            if not isinstance(given, Mapping):
                raise InputError(
                    f"plant shell, {what}", given, "values by the names of signals",
                    'write as in {"level_1": 2.0}',
                )  # fmt: skip
            for name, value in given.items():
                if not holds(value):
                    place = f"plant shell, {what}, {name}"
                    raise InputError(place, value, expected, "correct it, or leave it out")
        share = self.scan_tolerance
        if not (_is_rate(share) and share <= 1.0):
            raise InputError(
                "plant shell, scan_tolerance", share, "a share above 0 and at most 1",
                "write 0.1 for a tenth of the sampling period",
            )  # fmt: skip

    def check_names(self, controller: Controller) -> None:
        """Refuse settings for a signal that a controller does not have.

        Raises
        ------
        InputError

        Examples
        --------
        >>> import clepsydra as cl
        >>> controller = cl.design.simc(cl.load("quadruple-tank"))
        >>> PlantShell(sensor_delay={"level_7": 2.0}).check_names(controller)
        Traceback (most recent call last):
            ...
        clepsydra.base.errors.InputError: PI, SIMC, plant shell, sensor_delay: got 'level_7', \
expected a measurement of the controller: level_1, level_2; perhaps 'level_2' was meant.
        """
        for what, (of, _, _) in _SETTINGS.items():
            names = list(dict.fromkeys(getattr(controller, of)))
            for name in getattr(self, what):
                if name not in names:
                    raise InputError(
                        f"{controller.name}, plant shell, {what}", name,
                        f"a {_KINDS[of]} of the controller: {', '.join(names) or 'it has none'}",
                        suggestion(name, names, "correct the name or leave it out"),
                    )  # fmt: skip
