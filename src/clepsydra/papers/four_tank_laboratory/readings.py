"""What the report leaves open of the simulator, and claims that are judged by every reading of it.

The simulator has a noise of 30 %. It may be three standard deviations of the pumps' flow, or one,
as in a published copy that multiplies the flow by 1 + 0.3 times a standard normal number. And the
holes are those that the report identified, or in the minimum phase lower ones with which its manual
control makes the levels that it prints, and upper ones that these levels do not fix. The dynamic
decoupling, which a lag makes proper, has it in all of its entries or in those that need it. No
verdict may hang on any of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.words import listed
from clepsydra.papers.four_tank_laboratory.controllers import Kind, Lagged
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    Holes,
    Noise,
    SetUp,
)
from clepsydra.papers.printed import Printed
from clepsydra.papers.row import Row, joined

HOLES_IN_WORDS: dict[Holes, str] = {
    "report": "the report's holes",
    "lower fitted": "a1 and a2 fitted",
    "fitted": "all holes smaller",
}
#: Those that are noisy.
NOISES: tuple[Noise, ...] = ("three deviations", "one deviation")
LAGS_IN_WORDS: dict[Lagged, str] = {
    "all": "a lag of all of W",
    "diagonal": "a lag of W's diagonal alone",
}


@dataclass(frozen=True)
class Reading:
    """One way to read what the report leaves open."""

    holes: Holes
    noise: Noise
    lagged: Lagged = "all"

    def in_words(self, *, lag: bool) -> str:
        """Return it in words, with its lag where one is read in two ways."""
        return self.told(MINIMUM, lag=lag).replace("noise as", "30 % of noise as")

    def told(self, set_up: SetUp, *, lag: bool = False) -> str:
        """Return it in words where its noise is told of, and its holes if they are not given."""
        holes = [HOLES_IN_WORDS[self.holes]] if set_up is MINIMUM else []
        lags = [LAGS_IN_WORDS[self.lagged]] if lag else []
        return listed([*holes, f"noise as {self.noise}", *lags])

    def of(self, set_up: SetUp, kind: Kind = "decentralised") -> Reading:
        """Return the reading as a loop has it.

        Only the minimum phase has fitted holes, and only the robust controller of non-minimum phase
        a dynamic decoupling.
        """
        if set_up is MINIMUM:
            return Reading(self.holes, self.noise)
        return Reading("report", self.noise, self.lagged if has_lag(kind, set_up) else "all")


READINGS = tuple(
    Reading(holes, noise, lagged)
    for holes in HOLES_IN_WORDS
    for noise in NOISES
    for lagged in LAGS_IN_WORDS
)
#: The one whose numbers stand in the column of computed ones.
USUAL = READINGS[0]
#: The controllers are not printed either: a claim about the tables is judged by the tables as well,
#: and by the gain that ours were designed with, which the simulator makes three times as large.
ON_PAPER, DESIGNED = "the printed numbers", "our controllers in volts"


def has_lag(kind: Kind, set_up: SetUp) -> bool:
    """Return whether a loop has the lag of the decoupling, which is read in two ways."""
    return kind == "robust" and set_up is not MINIMUM


def readings_of(set_up: SetUp, kind: Kind = "decentralised") -> tuple[Reading, ...]:
    """Return the readings that differ for a loop."""
    return tuple(dict.fromkeys(reading.of(set_up, kind) for reading in READINGS))


def claimed_in_all(
    printed: Printed,
    holds: Mapping[Reading | str, float | np.ndarray],
    computed: str,
    readings: str,
    setting: str = "",
    *,
    lag: bool = False,
    shown: Callable[[Reading], str] | None = None,
) -> Row:
    """Judge a claim by every reading, and `ON_PAPER`; where they disagree it is but a remark.

    It holds by a reading where all is 1, fails where anything is 0, and is open where runs that
    overlap leave nan. `readings` and `setting` tell what was read in several ways, and what was
    run; `lag` says whether the lag of the decoupling is one of them; `shown` tells the figures of a
    reading in which the claim fails, where the row has others.

    Examples
    --------
    >>> both = {USUAL: True, ON_PAPER: True}
    >>> line = Printed("Table 5", "rise", 221, "slower", note="r")
    >>> claimed_in_all(line, both, "38 s", "any noise").reason
    'r It holds in all readings (any noise) and by the printed numbers.'
    >>> claimed_in_all(line, both | {USUAL: False}, "1", "any noise").verdict
    'remark'
    >>> row = claimed_in_all(line, both | {DESIGNED: np.nan}, "1", "any noise")
    >>> "is open with our controllers in volts, where runs overlap." in row.reason
    True
    """
    keys = sorted(holds, key=lambda key: key != ON_PAPER)
    agreeing = [key for key in keys if np.all(np.equal(holds[key], 1.0))]
    against = [key for key in keys if np.any(np.equal(holds[key], 0.0))]
    open_by = [key for key in keys if key not in agreeing and key not in against]
    words = [
        *(f"holds {_by(key, lag)}" for key in agreeing[:1]),
        *(f"fails {_by(key, lag)}{_figures(key, shown)}" for key in against[:1]),
        *(f"is open {_by(key, lag)}, where runs overlap" for key in open_by[:1]),
    ]
    usual = f"Shown is what comes out with {USUAL.in_words(lag=lag)}."
    if len(words) > 1 or open_by:
        said = f"It {', and '.join(words[:2])}."
        note = joined(printed.note, said, usual, setting)
        return replace(printed, note=note).remark(computed)
    others = [key for key in (ON_PAPER, DESIGNED) if key in holds]
    by = listed([f"in all readings ({readings})", *(_by(key, lag) for key in others)])
    said = f"It {'fails' if against else 'holds'} {by}."
    note = joined(printed.note, said, usual if setting else "", setting)
    return replace(printed, note=note).claimed(not against, computed)


def _by(key: Reading | str, lag: bool) -> str:
    words = key.in_words(lag=lag) if isinstance(key, Reading) else key
    return f"by {words}" if key == ON_PAPER else f"with {words}"


def _figures(key: Reading | str, shown: Callable[[Reading], str] | None) -> str:
    if shown is None or key == USUAL or not isinstance(key, Reading):
        return ""
    return f" ({shown(key)}), likewise without noise ({shown(replace(key, noise='none'))})"
