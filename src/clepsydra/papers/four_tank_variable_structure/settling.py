"""Section 5: whether the response is faster, by settling and by rise."""

from __future__ import annotations

from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.decoupled import READING, at_limit, decoupled
from clepsydra.papers.four_tank_variable_structure.readings import CONVENTIONAL, USUAL, both
from clepsydra.papers.row import Row


def speed() -> Row:
    """Compare settling and rise of both lower levels after decoupling."""
    lane = at_limit(USUAL.limit)
    settling, rise = (
        " against ".join(
            both(decoupled(way), what, form, lane) for way in ("variable_structure", CONVENTIONAL)
        )
        for what, form in (("settling", ".0f"), ("rise", ".1f"))
    )
    return PRINTED["section 5", "speed of the response"].remark(
        f"settling {settling} s; rise {rise} s",
        reason="h1 and h2. Which time is meant is not said: it holds of settling to 2 %, and fails "
        f"of the rise from 10 to 90 %. {READING}",
    )
