"""Exercises 4.1.1 and 4.1.2: decentralised PI control, Table 5."""

from __future__ import annotations

from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_laboratory.closed_loop import BAND
from clepsydra.papers.four_tank_laboratory.readings import (
    DESIGNED,
    MEDIANS,
    PRINTED,
    READINGS,
    USUAL,
    claimed_in_all,
)
from clepsydra.papers.four_tank_laboratory.set_ups import FULL_LEVEL, SET_UPS
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    TABLES,
    median,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Row


def run() -> Findings:
    """Step both references and pour, with the PI control."""
    return Findings(
        (*table_rows("decentralised"), *_claims()), tuple(table_figures("decentralised"))
    )


#: What a claim on a score is judged by, beside the medians.
_ENDS = {
    "rise": ", for each of them.",
    "recovery": f", back within {100 * BAND:g} % of 15 cm after {0.25 * FULL_LEVEL:g} cm are "
    "poured in; the report prints neither.",
    "overshoot": "; that of tank 1 is smaller, as is the printed one, so that it is not “always”.",
}


def _claims() -> list[Row]:
    rows = []
    printed = TABLES["decentralised"][1]
    for score, name, claim in (
        (
            "rise",
            "response",
            "the non-minimum one has lower response reaction …; the non-minimum phase case's … "
            "rise time are always larger than the minimum one",
        ),
        ("recovery", "recovery", "the non-minimum one has … higher recovery time"),
        (
            "overshoot",
            "oscillation",
            "the non-minimum phase case's oscillation amplitude … are always larger than the "
            "minimum one",
        ),
    ):
        values = {
            reading: [
                [median(score, set_up, "decentralised", tank, reading) for tank in (1, 2)]
                for set_up in SET_UPS
            ]
            for reading in READINGS
        } | {
            DESIGNED: [
                [median(score, set_up, "decentralised", tank, units="volts") for tank in (1, 2)]
                for set_up in SET_UPS
            ],
            PRINTED: [
                [float(number) for number in getattr(printed[set_up], score)] for set_up in SET_UPS
            ],
        }
        unit = "%" if score == "overshoot" else "s"
        rows.append(
            claimed_in_all(
                "Exercise 4.1.2", name, claim,
                {
                    reading: all(two > one for one, two in zip(*each, strict=True))
                    for reading, each in values.items()
                },
                "; ".join(
                    f"{set_up.phase} {one:.3g} and {two:.3g} {unit}"
                    for set_up, (one, two) in zip(SET_UPS, values[USUAL], strict=True)
                ),
                reason=f"{score.capitalize()}{' of the step' if score == 'overshoot' else ''} of "
                f"tanks 1 and 2 with PI controllers of ours, {MEDIANS}"
                + _ENDS[score],
            )
        )  # fmt: skip
    return rows
