"""Equations and figures that the text refers to by a number which belongs to another."""

from __future__ import annotations

from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import PENALTIES
from clepsydra.papers.row import Row

#: Its caption calls it (20), the text of section 3.2 "discrete model (21)".
_DISCRETE = "discrete model of Fig. 4, (21) in section 3.2"
#: What stands under each number.
EQUATIONS = {
    17: "criterion of identification",
    18: "model with estimated coefficients",
    20: "static gain",
    21: _DISCRETE,
    22: "first Diophantine equation",
    23: "second Diophantine equation",
    24: "feedforward gain r0",
    26: "quadratic criterion",
    27: "spectral factorisation",
    28: "polynomial of second order",
    29: "polynomial of third order",
    30: "product of real roots",
    32: "product with a complex pair",
}
FIGURES = {
    1: "schema of a tank",
    3: "criterion by the delay",
    4: "step responses",
    5: "block diagram of the predictor",
    10: "control courses by penalty",
    12: "control courses by penalty",
}
#: Place, the words around, what they speak of, and the kind of its number.
_REFERENCES = (
    ("section 3.1", "minimum of the criterion", EQUATIONS[17], "({})"),
    ("Fig. 4", "step responses of models (8) and", _DISCRETE, "({})"),
    ("section 3.2", "linear model obtained without hysteresis", _DISCRETE, "({})"),
    ("section 5", "R from equation, with z = 1", EQUATIONS[23], "({})"),
    ("section 3.1", "minimum of the criterion is obvious from", FIGURES[3], "Fig. {}"),
    ("section 4", "predicted error as shown in", FIGURES[5], "Fig. {}"),
)


def run() -> Found:
    """Return a row for each wrong reference."""
    rows = [_row(*reference) for reference in _REFERENCES]
    return (*rows, _second_order(), _caption())


def _row(place: str, words: str, meant: str, shape: str) -> Row:
    line = PRINTED[place, f"reference: {words}"]
    known = {
        shape.format(number): what
        for number, what in (EQUATIONS if shape == "({})" else FIGURES).items()
    }
    right = next(number for number, what in known.items() if what == meant)
    reason = f"The words speak of the {meant}; {line.text} is the {known[line.text]}."
    return line.stated(right, right == line.text, reason)


def _second_order() -> Row:
    reason = (
        f"(20) is the {EQUATIONS[20]}; the second-order model with d = 5 is (18) in letters and "
        "(21) in numbers."
    )
    return PRINTED["section 4", "reference: second-order linear model"].stated(
        "(21)", False, reason
    )


def _caption() -> Row:
    penalties, poles = ({getattr(each, what) for each in PENALTIES} for what in ("penalty", "pole"))
    return PRINTED["section 6.2", "what differs in Figs. 10 to 12"].stated(
        "individual penalization factors q_u", len(poles) > 1 or len(penalties) == 1
    )
