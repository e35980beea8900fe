"""Cross-references of the text: the number that is printed, and what the words around it mean."""

from __future__ import annotations

from clepsydra.papers.cross_references import wrong_references
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import PENALTIES

#: Place and the words around, to where that stands of which they speak.
_RIGHT = {
    ("section 3.1", "minimum of the criterion"): "(17)",
    ("Fig. 4", "step responses of models (8) and"): "(21)",
    ("section 3.2", "linear model obtained without hysteresis"): "(21)",
    ("section 5", "R from equation, with z = 1"): "(23)",
    ("section 3.1", "minimum of the criterion is obvious from"): "Fig. 3",
    ("section 4", "predicted error as shown in"): "Fig. 5",
    ("section 4", "second-order linear model"): "(21)",
}


def run() -> Found:
    """Return a row for each wrong reference."""
    yield from wrong_references(PRINTED, _RIGHT)
    poles, penalties = ({getattr(each, what) for each in PENALTIES} for what in ("pole", "penalty"))
    yield PRINTED["section 6.2", "what differs in Figs. 10 to 12"].stated(
        "individual penalization factors q_u", len(poles) > 1 or len(penalties) == 1
    )
