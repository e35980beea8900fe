"""Where the numbers of a printed program come from: for its head and its comments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.program.entries import Entry, signal_of


@dataclass(frozen=True)
class Origin:
    """What a program was made of.

    Parameters
    ----------
    subject : str
        What it is: "PI, SIMC" or "the process".
    process : str
        Name of the process and the file that describes it.
    design : str
        How the parameters were found, in one sentence; empty for a process.
    sampling_period : float
        The period that the numbers were designed for [s].
    sources : mapping
        Name of a state or parameter to where its number comes from.
    default_source : str
        Where a number that `sources` lacks comes from.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> origin = Origin("PI, SIMC", "quadruple-tank (catalogue)", "SIMC rules.", 1.0,
    ...                 {"pump_1.low_limit": "range of pump_1"}, "SIMC rules")
    >>> origin.source_of(Signal("pump_1.low_limit")), origin.source_of(Signal("gain"))
    ('range of pump_1', 'SIMC rules')
    """

    subject: str
    process: str
    design: str
    sampling_period: float
    sources: Mapping[str, str] = field(default_factory=dict)
    default_source: str = ""

    def source_of(self, entry: Entry) -> str:
        """Return where the number of a state or parameter comes from; empty if unknown."""
        return self.sources.get(signal_of(entry).name, self.default_source)

    def lines(self) -> list[str]:
        """Return the lines that the head of a printed file says of it.

        >>> Origin("PI, SIMC", "quadruple-tank (catalogue)", "SIMC rules.", 1.0).lines()[0]
        'PI, SIMC for quadruple-tank (catalogue), sampled every 1 s.'
        """
        about = f"{self.subject} for {self.process}, sampled every {self.sampling_period:.12g} s."
        return [about, *([f"Design: {self.design}"] if self.design else [])]
