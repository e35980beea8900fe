"""What may be done to a soft PLC while it runs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """Something that is done to a soft PLC between two scans.

    Parameters
    ----------
    at : int
        Once this sample of the plant, or a later one, has been read; at once if left out.
    """

    at: int = 0


@dataclass(frozen=True)
class Stop(Command):
    """STOP, and RUN again after a time: the program keeps all it has, and the clock runs on.

    Parameters
    ----------
    seconds : float
        Of the plant [s].
    """

    seconds: float = 0.0


@dataclass(frozen=True)
class PowerCycle(Command):
    """Power off, and on again after a time: the program begins anew, with `start` at 1.

    Parameters
    ----------
    seconds : float
        Without power, of the plant [s].
    retained : bool
        Whether what is declared RETAIN is kept.
    """

    seconds: float = 0.0
    retained: bool = True


@dataclass(frozen=True)
class Delay(Command):
    """Let some scans begin late.

    Parameters
    ----------
    seconds : float
        By which, of the plant [s].
    scans : int
    """

    seconds: float = 0.0
    scans: int = 1


@dataclass(frozen=True)
class Skip(Command):
    """Leave out some scans.

    Parameters
    ----------
    scans : int
    """

    scans: int = 1


@dataclass(frozen=True)
class Finish(Command):
    """End, and hand over the record."""
