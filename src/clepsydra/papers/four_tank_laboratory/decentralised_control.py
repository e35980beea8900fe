"""Exercise 4.1: decentralised PI control, Table 5, Figs. 7 and 8."""

from __future__ import annotations

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_laboratory.step_and_pours import (
    beside_minimum,
    table_figures,
    table_rows,
)


def run() -> Found:
    """Step both references and pour, with the PI control."""
    yield from table_rows("decentralised")
    claims = {"response": "rise", "recovery": "recovery", "oscillation": "overshoot"}
    for name, score in claims.items():
        yield beside_minimum("decentralised", "Exercise 4.1.2", name, score, 1.0)
    yield from table_figures("decentralised")
