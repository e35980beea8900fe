"""Exercises 4.2.1 to 4.2.3: Glover-McFarlane control, Table 6, beside Table 5."""

from __future__ import annotations

import math

from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_laboratory.set_ups import (
    MINIMUM,
    NON_MINIMUM,
    SET_UPS,
    SetUp,
    Units,
)
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    TABLES,
    median,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Row

_UNITS: tuple[Units, Units] = ("volts", "percent")


def run() -> Findings:
    """Step both references and pour, with the robust control."""
    return Findings(
        (*table_rows("robust"), *_beside_decentralised(), *_beside_minimum(), _units()),
        tuple(table_figures("robust")),
    )


def _beside_decentralised() -> list[Row]:
    rows = []
    for score, claim, sign in (
        ("overshoot", "smaller with Glover-McFarlane", -1.0),
        ("rise", "longer with Glover-McFarlane", 1.0),
        ("recovery", "Glover-McFarlane attenuates the disturbance faster", -1.0),
    ):
        for set_up in SET_UPS:
            pairs = [
                tuple(median(score, set_up, kind, tank) for kind in ("decentralised", "robust"))
                for tank in (1, 2)
            ]
            in_volts = [
                tuple(
                    median(score, set_up, kind, tank, "volts")
                    for kind in ("decentralised", "robust")
                )
                for tank in (1, 2)
            ]
            unit = "%" if score == "overshoot" else "s"
            rows.append(
                claimed(
                    "Exercise 4.2.2", f"{score}, {set_up.phase}", claim,
                    all(sign * (two - one) > 0.0 for one, two in pairs), _pairs(pairs, unit),
                    reason="PI to Glover-McFarlane, tank 1 and tank 2, medians in percent; in "
                    f"volts {_pairs(in_volts, unit)}. The printed tables have "
                    f"{_printed(score, set_up, unit)}.",
                )
            )  # fmt: skip
    shares = {set_up: [_ratio("overshoot", set_up, tank) for tank in (1, 2)] for set_up in SET_UPS}
    times = {set_up: [_ratio("rise", set_up, tank) for tank in (1, 2)] for set_up in SET_UPS}
    more = max(shares[NON_MINIMUM]) < min(shares[MINIMUM]) and min(times[NON_MINIMUM]) > max(
        times[MINIMUM]
    )
    rows.append(
        claimed(
            "Exercise 4.2.2", "trade of overshoot for rise time",
            "much more significant in the non-minimum phase", more,
            "; ".join(
                f"{set_up.phase}: overshoot × {shares[set_up][0]:.2f} and "
                f"{shares[set_up][1]:.2f}, rise × {times[set_up][0]:.2f} and "
                f"{times[set_up][1]:.2f}"
                for set_up in SET_UPS
            ),
            reason="Glover-McFarlane over PI, tanks 1 and 2, medians in percent.",
        )
    )  # fmt: skip
    return rows


def _beside_minimum() -> list[Row]:
    rows = []
    for score, name, claim, sign in (
        ("rise", "response", "slower in the non-minimum phase", 1.0),
        ("recovery", "recovery", "slower in the non-minimum phase", 1.0),
        ("overshoot", "overshoot", "much larger in the minimum phase", -1.0),
    ):
        values = {
            set_up: [median(score, set_up, "robust", tank) for tank in (1, 2)] for set_up in SET_UPS
        }
        unit = "%" if score == "overshoot" else "s"
        rows.append(
            claimed(
                "Exercise 4.2.3", name, claim,
                all(sign * (two - one) > 0.0 for one, two in zip(*values.values(), strict=True)),
                "; ".join(
                    f"{set_up.phase} {one:.3g} and {two:.3g} {unit}"
                    for set_up, (one, two) in values.items()
                ),
                reason=f"{score.capitalize()} of tanks 1 and 2 with Glover-McFarlane, medians in "
                "percent.",
            )
        )  # fmt: skip
    return rows


def _units() -> Row:
    """Ask which gain the printed times speak for."""
    nearer = []
    for kind, (_, lines) in TABLES.items():
        for set_up, line in lines.items():
            for tank in (1, 2):
                printed = float(line.rise[tank - 1])
                off = [
                    abs(math.log(median("rise", set_up, kind, tank, units) / printed))
                    for units in _UNITS
                ]
                nearer.append(off[0] < off[1])
    return claimed(
        "Tables 5 and 6", "gain of the loops", "controllers as they were designed",
        sum(nearer) > len(nearer) // 2,
        f"{len(nearer) - sum(nearer)} of {len(nearer)} rise times are nearer to three times the "
        "gain",
        reason="Rise times of the same controllers in volts, as designed, and in percent, as the "
        "simulator takes them: what is printed was measured with loops of three times the gain.",
    )  # fmt: skip


def _ratio(score: str, set_up: SetUp, tank: int) -> float:
    return median(score, set_up, "robust", tank) / median(score, set_up, "decentralised", tank)


def _pairs(pairs: list[tuple[float, ...]], unit: str) -> str:
    return ", ".join(f"{one:.3g} to {two:.3g} {unit}" for one, two in pairs)


def _printed(score: str, set_up: SetUp, unit: str) -> str:
    one, two = (getattr(TABLES[kind][1][set_up], score) for kind in ("decentralised", "robust"))
    return ", ".join(f"{a} to {b} {unit}" for a, b in zip(one, two, strict=True))
