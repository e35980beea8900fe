"""A delay ring: a value that is read some samples, or turns of a loop, after it was written."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal


@dataclass(frozen=True)
class DelayRing:
    """A state whose value read at sample k is the value written at sample k - length.

    A ring of a counted loop counts its turns instead, on from sample to sample.

    Every printer keeps it as an array of `length` numbers and one position; nothing is
    shifted, so a long delay costs no more than a short one.

    Parameters
    ----------
    signal : Signal
        Name, unit and initial content of the ring.
    length : int
        Delay [samples, or turns of the loop], at least 1; a length of 1 is an ordinary state.

    Raises
    ------
    InputError
        The length is below one.

    Examples
    --------
    >>> DelayRing(Signal("flow", "m^3/s"), length=5).name
    'flow'
    """

    signal: Signal
    length: int

    def __post_init__(self) -> None:
        if self.length < 1:
            place, expected = f"delay ring {self.signal.name}", "a length of at least 1 sample"
            remedy = "give the dead time as a whole number of sampling periods"
            raise InputError(place, self.length, expected, remedy)

    @property
    def name(self) -> str:
        """The name of the delayed signal."""
        return self.signal.name
