"""What an engineer may set of the plant shell, by the names of the process signals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER

_LARGEST = f"0 and at most {LARGEST_PARAMETER:g}"


def _is_delay(value: float) -> bool:
    return 0.0 <= value <= LARGEST_PARAMETER


def _is_rate(value: float) -> bool:
    return 0.0 < value <= LARGEST_PARAMETER


#: Of which signals of a controller a setting is, one of them in words, which finite numbers it may
#: be, and how that is told.
_SETTINGS: dict[str, tuple[str, str, Callable[[float], bool], str]] = {
    "sensor_delay": (
        "measurements", "measurement", _is_delay, f"a number at or above {_LARGEST}",
    ),
    "setpoint_rate": (
        "setpoints", "controlled measurement", _is_rate, f"a number above {_LARGEST}",
    ),
    "rate_limit": ("manipulated", "manipulated variable", _is_rate, f"a number above {_LARGEST}"),
    "fail_safe": ("manipulated", "manipulated variable", math.isfinite, "a finite number"),
    "interlock": ("manipulated", "manipulated variable", math.isfinite, "a finite number"),
}  # fmt: skip


@dataclass(frozen=True)
class PlantShell:
    """Settings of the plant shell; what is left out has the value that does nothing.

    Parameters
    ----------
    sensor_delay : mapping
        Measurement to how long a fault of it is ridden through [s]; 4 s if left out.
    setpoint_rate : mapping
        Controlled measurement to the largest rate of its setpoint [unit/s]; none if left out.
    rate_limit : mapping
        Manipulated variable to its largest rate [unit/s]; none if left out.
    fail_safe : mapping
        Manipulated variable to its value after a fault [unit]; its low limit if left out.
    interlock : mapping
        Manipulated variable that alarms hold to the value at which they do [unit]; none if left
        out, and then it has no input for it.

    Raises InputError: A value is no number, or outside what is possible.
    """

    sensor_delay: Mapping[str, float] = field(default_factory=dict)
    setpoint_rate: Mapping[str, float] = field(default_factory=dict)
    rate_limit: Mapping[str, float] = field(default_factory=dict)
    fail_safe: Mapping[str, float] = field(default_factory=dict)
    interlock: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for what, (_, _, holds, expected) in _SETTINGS.items():
            for name, value in getattr(self, what).items():
                if not (is_finite_number(value) and holds(value)):
                    place = f"plant shell, {what}, {name}"
                    raise InputError(place, value, expected, "correct it, or leave it out")

    def check_names(self, controller: Controller) -> None:
        """Refuse settings for a signal that a controller does not have."""
        for what, (of, words, _, _) in _SETTINGS.items():
            names = list(dict.fromkeys(getattr(controller, of)))
            for name in getattr(self, what):
                if name not in names:
                    raise InputError(
                        f"{controller.name}, plant shell, {what}", name,
                        f"a {words} of the controller: {', '.join(names) or 'it has none'}",
                        suggestion(name, names, "correct the name or leave it out"),
                    )  # fmt: skip
