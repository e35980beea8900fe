"""Exercises 4.2.1 to 4.2.3: Glover-McFarlane control, Table 6, beside Table 5."""

from __future__ import annotations

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.closed_loop import Kind
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    MEDIANS,
    USUAL,
    Reading,
    claimed_in_all,
)
from clepsydra.papers.four_tank_laboratory.set_ups import NON_MINIMUM, SET_UPS, SetUp
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    GLOVER,
    beside_minimum,
    everywhere,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Row, Rows

_KINDS: tuple[Kind, Kind] = ("decentralised", "robust")


def run() -> Found:
    """Step both references and pour, with the robust control."""
    rows = *table_rows("robust"), *_beside_decentralised(), _trade(), *_beside_minimum()
    return (*rows, *table_figures("robust"))


def _beside_decentralised() -> Rows:
    for score, sign in (("overshoot", -1.0), ("rise", 1.0), ("recovery", -1.0)):
        pairs, of_score = _pairs(score), ""
        if score == "overshoot":
            # There neither controller overshoots but for the noise.
            del pairs[DESIGNED][NON_MINIMUM][0]
            of_score = (
                " Up to the first pour, at 150 and 800 s; in volts tank 1 of non-minimum phase is "
                "left out, where neither controller overshoots beyond the noise."
            )
        unit = "%" if score == "overshoot" else "s"
        holds = {
            reading: all(sign * (two - one) > 0.0 for each in found.values() for one, two in each)
            for reading, found in pairs.items()
        }
        told = "; ".join(
            f"{set_up.phase} {', '.join(f'{one:.3g} to {two:.3g} {unit}' for one, two in each)}"
            for set_up, each in pairs[USUAL].items()
        )
        reason = (
            f"PI to {GLOVER} in both tanks of both set-ups, controllers of ours, "
            f"{MEDIANS}.{of_score}"
        )
        yield claimed_in_all(PRINTED["Exercise 4.2.2", score], holds, told, reason=reason)


def _pairs(score: str) -> dict[Reading | str, dict[SetUp, list[tuple[float, float]]]]:
    """Return PI and Glover-McFarlane control of both tanks, in every reading."""
    plain, robust = (everywhere(kind, score) for kind in _KINDS)
    return {
        reading: {
            set_up: list(zip(each[set_up], robust[reading][set_up], strict=True)) for set_up in each
        }
        for reading, each in plain.items()
    }


def _trade() -> Row:
    """Judge whether more overshoot is traded for less rise time with non-minimum phase."""
    over, rise = (
        {
            reading: {s: [robust / plain for plain, robust in pairs] for s, pairs in each.items()}
            for reading, each in _pairs(score).items()
        }
        for score in ("overshoot", "rise")
    )
    holds = {
        reading: all(
            sign * (other - one) > 0.0
            for shares, sign in ((over[reading], -1.0), (rise[reading], 1.0))
            for one, other in zip(*shares.values(), strict=True)
        )
        for reading in over
    }
    told = "; ".join(
        f"{s.phase}: overshoot × {over[USUAL][s][0]:.2f} and {over[USUAL][s][1]:.2f}, "
        f"rise × {rise[USUAL][s][0]:.2f} and {rise[USUAL][s][1]:.2f}"
        for s in SET_UPS
    )
    return claimed_in_all(
        PRINTED["Exercise 4.2.2", "trade of overshoot for rise time"],
        holds,
        told,
        reason=f"{GLOVER} over PI, tank 1 and tank 2, controllers of ours, {MEDIANS}; "
        "judged as more in each tank, by both.",
    )


def _beside_minimum() -> Rows:
    for score, name, sign, end in (
        ("rise", "response", 1.0, "."),
        ("recovery", "recovery", 1.0, "."),
        ("overshoot", "overshoot", -1.0, " as larger."),
    ):
        reason = (
            f"{score.capitalize()} of tanks 1 and 2 under {GLOVER}, controllers of ours, "
            f"{MEDIANS}; judged for each{end}"
        )
        line = PRINTED["Exercise 4.2.3", name]
        yield beside_minimum("robust", line, score, sign, reason)
