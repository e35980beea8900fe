"""Exercise 4.2: Glover-McFarlane control, Table 6, Figs. 9 and 10, and beside PI control."""

from __future__ import annotations

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.readings import DESIGNED, MEDIANS, USUAL, claimed_in_all
from clepsydra.papers.four_tank_laboratory.set_ups import NON_MINIMUM, SET_UPS
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    GLOVER,
    UNITS,
    beside_minimum,
    everywhere,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Row, Rows

_PLACE = "Exercise 4.2.2"


def run() -> Found:
    """Step both references and pour, with the robust control."""
    yield from (*table_rows("robust"), *_beside_decentralised(), _trade())
    for name, score, sign in (
        ("response", "rise", 1.0),
        ("recovery", "recovery", 1.0),
        ("overshoot", "overshoot", -1.0),
    ):
        yield beside_minimum("robust", "Exercise 4.2.3", name, score, sign)
    yield from table_figures("robust")


def _beside_decentralised() -> Rows:
    for score, sign in (("overshoot", -1.0), ("rise", 1.0), ("recovery", -1.0)):
        plain, robust = everywhere("decentralised", score), everywhere("robust", score)
        holds = {reading: sign * robust[reading] > sign * plain[reading] for reading in plain}
        if score == "overshoot":
            # There neither controller overshoots but for the noise.
            holds[DESIGNED][SET_UPS.index(NON_MINIMUM), 0] = True
        found = {
            set_up: ", ".join(
                f"{one:.3g} to {two:.3g} {UNITS[score]}" for one, two in zip(*pair, strict=True)
            )
            for set_up, *pair in zip(SET_UPS, plain[USUAL], robust[USUAL], strict=True)
        }
        told = "; ".join(f"{set_up.phase} {words}" for set_up, words in found.items())
        line = PRINTED[_PLACE, score].told(glover=GLOVER, medians=MEDIANS)
        yield claimed_in_all(line, holds, told)


def _trade() -> Row:
    """Judge whether more overshoot is traded for less rise time with non-minimum phase."""
    over, rise = (
        {
            reading: everywhere("robust", score)[reading] / plain
            for reading, plain in everywhere("decentralised", score).items()
        }
        for score in ("overshoot", "rise")
    )
    holds = {
        reading: np.append(over[reading][1] < over[reading][0], rise[reading][1] > rise[reading][0])
        for reading in over
    }
    told = "; ".join(
        f"{set_up.phase}: overshoot × {o[0]:.2f} and {o[1]:.2f}, rise × {r[0]:.2f} and {r[1]:.2f}"
        for set_up, o, r in zip(SET_UPS, over[USUAL], rise[USUAL], strict=True)
    )
    line = PRINTED[_PLACE, "trade of overshoot for rise time"]
    return claimed_in_all(line.told(glover=GLOVER, medians=MEDIANS), holds, told)
