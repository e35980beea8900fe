"""How late and how seldom a sensor tells what it reads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from clepsydra.base.words import time_text


class ReportedSamples(NamedTuple):
    """How late and how seldom a measurement is told, in sampling periods.

    Parameters
    ----------
    late : int
        From the reading to the sample in which it is told.
    every : int
        From one report to the next; what was told last is held in between.
    first : int
        Samples before the first report of a run.
    """

    late: int
    every: int
    first: int

    @property
    def mean_age(self) -> float:
        """How old what is told is on the average of all samples, in sampling periods."""
        return self.late + (self.every - 1) / 2


@dataclass(frozen=True)
class Reporting:
    """How late and how seldom a measurement is told.

    Parameters
    ----------
    dead_time : float
        From the reading to the report [s].
    sampling : float
        From one report to the next; 0 for what is told in every sample [s].
    first_report : float
        After the start of a run [s].

    Examples
    --------
    An analyser that takes 40 s and reports each minute, under a controller that looks every 5 s:

    >>> samples = Reporting(dead_time=40.0, sampling=60.0).samples(5.0)
    >>> samples, samples.mean_age
    (ReportedSamples(late=8, every=12, first=0), 13.5)
    """

    dead_time: float = 0.0
    sampling: float = 0.0
    first_report: float = 0.0

    @property
    def words(self) -> str:
        """How it reports, in words.

        Examples
        --------
        >>> Reporting(dead_time=40.0).words, Reporting(dead_time=90.0, sampling=300.0).words
        ('40 s late', 'reports every 5 min, 90 s late')
        """
        if not self.sampling:
            return f"{time_text(self.dead_time)} late"
        reports = f"reports every {time_text(self.sampling)}"
        return f"{reports}, {time_text(self.dead_time)} late" if self.dead_time else reports

    def samples(self, period: float) -> ReportedSamples:
        """Return the same in sampling periods of some seconds, to the nearest whole number."""
        late, every, first = (
            round(time / period) for time in (self.dead_time, self.sampling, self.first_report)
        )
        return ReportedSamples(late, max(every, 1), first)
