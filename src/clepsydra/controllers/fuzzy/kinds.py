"""What linguistic variables stand for in a process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Quantity = Literal["error", "error_rate", "measurement", "measurement_rate"]
Action = Literal["position", "increment"]


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


def followed_measurements(measured: Sequence[str], inputs: Sequence[FuzzyInput]) -> tuple[str, ...]:
    """Return the measurements whose errors are used, in their order.

    Examples
    --------
    >>> inputs = [FuzzyInput("measurement", "flow"), FuzzyInput("error", "level")]
    >>> followed_measurements(["flow", "level"], inputs)
    ('level',)
    """
    used = {each.measurement for each in inputs if each.is_of_error}
    return tuple(name for name in measured if name in used)
