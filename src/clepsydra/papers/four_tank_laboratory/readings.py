"""What the report leaves open of the simulator, and claims that are judged by every reading of it.

The simulator has a noise of 30 %. It may be three standard deviations of the pumps' flow, or one,
as in a published copy that multiplies the flow by 1 + 0.3 times a standard normal number. And the
holes are those that the report identified, or in the minimum phase those with which its manual
control makes the levels that it prints. No verdict may hang on either.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    OF_THE_COURSE,
    UNCONVERTED,
    Holes,
    Noise,
    SetUp,
)
from clepsydra.papers.four_tank_laboratory.simulator import SEEDS
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row

#: Those that are noisy.
NOISES: tuple[Noise, ...] = ("three deviations", "one deviation")


@dataclass(frozen=True)
class Reading:
    """One way to read what the report leaves open."""

    holes: Holes
    noise: Noise

    def __str__(self) -> str:
        holes = "the report's holes" if self.holes == "report" else "fitted holes"
        return f"{holes} and 30 % as {self.noise}"

    def of(self, set_up: SetUp) -> Reading:
        """Return the reading as a set-up has it: only the minimum phase has fitted holes."""
        return self if set_up is MINIMUM else Reading("report", self.noise)


READINGS = tuple(Reading(holes, noise) for holes in ("report", "fitted") for noise in NOISES)
#: The one whose numbers stand in the column of computed ones.
USUAL = READINGS[0]
#: Of which runs the figures of a claim are.
MEDIANS = (
    f"designed in volts and run {UNCONVERTED}: medians of {SEEDS} runs ({USUAL}, with "
    f"{OF_THE_COURSE})"
)
#: The controllers are not printed either: a claim about the tables is judged by the tables as well,
#: and by the gain that ours were designed with, which the simulator makes three times as large.
ON_PAPER, DESIGNED = "the printed numbers", "our controllers in volts"


def readings_of(set_up: SetUp) -> tuple[Reading, ...]:
    """Return the readings that differ for a set-up."""
    return tuple(dict.fromkeys(reading.of(set_up) for reading in READINGS))


def claimed_in_all(
    printed: Printed, holds: Mapping[Reading | str, bool | np.ndarray], computed: str
) -> Row:
    """Judge a claim by every reading, and `ON_PAPER`; where they disagree it is but a remark.

    Examples
    --------
    >>> both = {USUAL: True, ON_PAPER: True}
    >>> line = Printed("Table 5", "rise", 221, "slower", note="r")
    >>> claimed_in_all(line, both, "38 s").verdict
    'claim holds'
    >>> claimed_in_all(line, both | {USUAL: False}, "1").verdict
    'remark'
    """
    keys = sorted(holds, key=lambda key: key != ON_PAPER)
    agreeing = [key for key in keys if np.all(holds[key])]
    against = [key for key in keys if key not in agreeing]
    if agreeing and against:
        said = f"It holds by {agreeing[0]}, and fails by {against[0]}."
        return replace(printed, note=f"{printed.note} {said}").remark(computed)
    others = "".join(f", by {key}" for key in (ON_PAPER, DESIGNED) if key in holds)
    said = f"So in all readings of noise and holes{others}."
    return replace(printed, note=f"{printed.note} {said}").claimed(not against, computed)


def agreeing(holds: dict[Reading, bool]) -> tuple[Reading | None, Reading | None]:
    """Return the first reading that agrees, and the first that does not."""
    first = {agrees: reading for reading, agrees in reversed(holds.items())}
    return first.get(True), first.get(False)
