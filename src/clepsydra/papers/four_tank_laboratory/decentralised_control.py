"""Exercises 4.1.1 and 4.1.2: decentralised PI control, Table 5."""

from __future__ import annotations

from clepsydra.papers.comparison import claimed
from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, NON_MINIMUM
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


def _said(on_paper: list[bool]) -> str:
    against = [f"tank {tank}" for tank, agrees in enumerate(on_paper, start=1) if not agrees]
    return f"contradict it for {' and '.join(against)}" if against else "say so as well"


def _claims() -> list[Row]:
    rows = []
    printed = TABLES["decentralised"][1]
    for score, name, claim in (
        ("rise", "response", "the non-minimum phase responds more slowly"),
        ("recovery", "recovery", "the non-minimum phase recovers more slowly"),
        ("overshoot", "oscillation", "always larger in the non-minimum phase"),
    ):
        values = {
            set_up: [median(score, set_up, "decentralised", tank) for tank in (1, 2)]
            for set_up in (MINIMUM, NON_MINIMUM)
        }
        worse = [two > one for one, two in zip(*values.values(), strict=True)]
        on_paper = [
            float(two) > float(one)
            for one, two in zip(
                getattr(printed[MINIMUM], score), getattr(printed[NON_MINIMUM], score), strict=True
            )
        ]
        unit = "%" if score == "overshoot" else "s"
        figures = "; ".join(
            f"{set_up.phase} {one:.3g} and {two:.3g} {unit}"
            for set_up, (one, two) in values.items()
        )
        rows.append(
            claimed(
                "Exercise 4.1.2", name, claim, all(worse), figures,
                reason=f"{score.capitalize()} of tanks 1 and 2, medians in percent. The printed "
                f"numbers {_said(on_paper)}.",
            )
        )  # fmt: skip
    return rows
