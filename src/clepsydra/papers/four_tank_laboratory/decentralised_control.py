"""Exercises 4.1.1 and 4.1.2: decentralised PI control, Table 5."""

from __future__ import annotations

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.closed_loop import BAND
from clepsydra.papers.four_tank_laboratory.readings import MEDIANS
from clepsydra.papers.four_tank_laboratory.set_ups import FULL_LEVEL
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    beside_minimum,
    table_figures,
    table_rows,
)
from clepsydra.papers.row import Rows


def run() -> Found:
    """Step both references and pour, with the PI control."""
    return (*table_rows("decentralised"), *_claims(), *table_figures("decentralised"))


#: What a claim on a score is judged by, beside the medians.
_ENDS = {
    "rise": ", for each of them.",
    "recovery": f", back within {100 * BAND:g} % of 15 cm after {0.25 * FULL_LEVEL:g} cm are "
    "poured in; the report prints neither.",
    "overshoot": "; that of tank 1 is smaller, as is the printed one, so that it is not “always”.",
}


def _claims() -> Rows:
    names = {"rise": "response", "recovery": "recovery", "overshoot": "oscillation"}
    for score, name in names.items():
        reason = (
            f"{score.capitalize()}{' of the step' if score == 'overshoot' else ''} of tanks 1 and "
            f"2 with PI controllers of ours, {MEDIANS}{_ENDS[score]}"
        )
        line = PRINTED["Exercise 4.1.2", name]
        yield beside_minimum("decentralised", line, score, 1.0, reason)
