"""Exercises 4.2.1 to 4.2.3: Glover-McFarlane control, Table 6, beside Table 5."""

from __future__ import annotations

from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    MEDIANS,
    PRINTED,
    READINGS,
    USUAL,
    Reading,
    claimed_in_all,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    SET_UPS,
    SetUp,
    Units,
)
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    GLOVER,
    TABLES,
    median,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Row


def run() -> Findings:
    """Step both references and pour, with the robust control."""
    return Findings(
        (
            *table_rows("robust"), *_beside_decentralised(), _trade(), *_beside_minimum(),
        ),
        tuple(table_figures("robust")),
    )  # fmt: skip


def _beside_decentralised() -> list[Row]:
    rows = []
    for score, claim, sign in (
        ("overshoot", "Glover-McFarlane have smaller overshoot", -1.0),
        ("rise", "have a longer rise time as a result", 1.0),
        (
            "recovery",
            "attenuate the disturbance faster as you can see in the recovery time column",
            -1.0,
        ),
    ):
        in_volts = {set_up: _beside(score, set_up, USUAL, "volts") for set_up in SET_UPS}
        of_score = ""
        if score == "overshoot":
            # There neither controller overshoots but for the noise.
            del in_volts[NON_MINIMUM][0]
            of_score = (
                " Up to the first pour, at 150 and 800 s; in volts tank 1 of non-minimum phase is "
                "left out, where neither controller overshoots beyond the noise."
            )
        pairs = {
            reading: {set_up: _beside(score, set_up, reading) for set_up in SET_UPS}
            for reading in READINGS
        } | {
            DESIGNED: in_volts,
            PRINTED: {set_up: _on_paper(score, set_up) for set_up in SET_UPS},
        }
        unit = "%" if score == "overshoot" else "s"
        rows.append(
            claimed_in_all(
                "Exercise 4.2.2", score, claim,
                {
                    reading: all(
                        sign * (two - one) > 0.0 for each in found.values() for one, two in each
                    )
                    for reading, found in pairs.items()
                },
                "; ".join(
                    f"{set_up.phase} {_pairs(each, unit)}" for set_up, each in pairs[USUAL].items()
                ),
                reason=f"PI to {GLOVER} in both tanks of both set-ups, controllers of ours, "
                f"{MEDIANS}.{of_score}",
            )
        )  # fmt: skip
    return rows


def _beside(
    score: str, set_up: SetUp, reading: Reading, units: Units = "percent"
) -> list[tuple[float, float]]:
    """Return PI and Glover-McFarlane control of both tanks."""
    return [
        (
            median(score, set_up, "decentralised", tank, reading, units),
            median(score, set_up, "robust", tank, reading, units),
        )
        for tank in (1, 2)
    ]


def _on_paper(score: str, set_up: SetUp) -> list[tuple[float, float]]:
    """Return the same as it is printed."""
    plain, robust = (getattr(TABLES[kind][1][set_up], score) for kind in TABLES)
    return [(float(one), float(two)) for one, two in zip(plain, robust, strict=True)]


def _trade() -> Row:
    scores = ("overshoot", "rise")
    shares = {
        reading: {
            set_up: [_shares(_beside(score, set_up, reading)) for score in scores]
            for set_up in SET_UPS
        }
        for reading in READINGS
    } | {
        DESIGNED: {
            set_up: [_shares(_beside(score, set_up, USUAL, "volts")) for score in scores]
            for set_up in SET_UPS
        },
        PRINTED: {
            set_up: [_shares(_on_paper(score, set_up)) for score in scores] for set_up in SET_UPS
        },
    }
    return claimed_in_all(
        "Exercise 4.2.2", "trade of overshoot for rise time",
        "This is shown much more significantly for non-minimum phase case",
        {
            reading: all(
                other < one
                for one, other in zip(each[MINIMUM][0], each[NON_MINIMUM][0], strict=True)
            )
            and all(
                other > one
                for one, other in zip(each[MINIMUM][1], each[NON_MINIMUM][1], strict=True)
            )
            for reading, each in shares.items()
        },
        "; ".join(
            f"{set_up.phase}: overshoot × {over[0]:.2f} and {over[1]:.2f}, rise × {rise[0]:.2f} "
            f"and {rise[1]:.2f}"
            for set_up, (over, rise) in shares[USUAL].items()
        ),
        reason=f"{GLOVER} over PI, tank 1 and tank 2, controllers of ours, {MEDIANS}; "
        "judged as more in each tank, by both.",
    )  # fmt: skip


def _shares(pairs: list[tuple[float, float]]) -> list[float]:
    """Return Glover-McFarlane over PI for each tank."""
    return [robust / plain for plain, robust in pairs]


def _beside_minimum() -> list[Row]:
    rows = []
    for score, name, claim in (
        (
            "rise",
            "response",
            "the non-minimum one has lower response reaction …; the non-minimum phase case's rise "
            "time are always larger than the minimum one",
        ),
        ("recovery", "recovery", "the non-minimum one has … higher recovery time"),
        ("overshoot", "overshoot", "the minimum phase system has much larger overshoot value"),
    ):
        values = {
            reading: [
                [median(score, set_up, "robust", tank, reading) for tank in (1, 2)]
                for set_up in SET_UPS
            ]
            for reading in READINGS
        } | {
            DESIGNED: [
                [median(score, set_up, "robust", tank, units="volts") for tank in (1, 2)]
                for set_up in SET_UPS
            ],
            PRINTED: [[two for _, two in _on_paper(score, set_up)] for set_up in SET_UPS],
        }
        unit, sign = ("%", -1.0) if score == "overshoot" else ("s", 1.0)
        rows.append(
            claimed_in_all(
                "Exercise 4.2.3", name, claim,
                {
                    reading: all(
                        sign * (two - one) > 0.0 for one, two in zip(*each, strict=True)
                    )
                    for reading, each in values.items()
                },
                "; ".join(
                    f"{set_up.phase} {one:.3g} and {two:.3g} {unit}"
                    for set_up, (one, two) in zip(SET_UPS, values[USUAL], strict=True)
                ),
                reason=f"{score.capitalize()} of tanks 1 and 2 under {GLOVER}, controllers "
                f"of ours, {MEDIANS}; judged for each"
                + (
                    " as larger."
                    if score == "overshoot"
                    else "."
                ),
            )
        )  # fmt: skip
    return rows


def _pairs(pairs: list[tuple[float, float]], unit: str) -> str:
    return ", ".join(f"{one:.3g} to {two:.3g} {unit}" for one, two in pairs)
