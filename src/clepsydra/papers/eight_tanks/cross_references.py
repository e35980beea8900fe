"""Equations and figures that the text refers to by a number which belongs to another."""

from __future__ import annotations

from clepsydra.papers.comparison import stated
from clepsydra.papers.experiment import Findings
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
#: Place, the words around, the number that is printed, and what they speak of.
_TO_EQUATIONS = (
    ("section 3.1", "minimum of the criterion", 21, "criterion of identification"),
    ("Fig. 4", "step responses of models (8) and", 20, _DISCRETE),
    ("section 3.2", "linear model obtained without hysteresis", 20, _DISCRETE),
    ("section 5", "R from equation, with z = 1", 24, "second Diophantine equation"),
)  # fmt: skip
_TO_FIGURES = (
    ("section 3.1", "minimum of the criterion is obvious from", 4, "criterion by the delay"),
    ("section 4", "predicted error as shown in", 1, "block diagram of the predictor"),
)


def run() -> Findings:
    """Return a row for each wrong reference."""
    rows = [
        _row(place, words, f"({printed})", meant, "({})", EQUATIONS[printed], EQUATIONS)
        for place, words, printed, meant in _TO_EQUATIONS
    ]
    rows += [
        _row(place, words, f"Fig. {printed}", meant, "Fig. {}", FIGURES[printed], FIGURES)
        for place, words, printed, meant in _TO_FIGURES
    ]
    return Findings((*rows, _second_order(), _caption()))


def _row(
    place: str,
    words: str,
    printed: str,
    meant: str,
    shape: str,
    stands: str,
    known: dict[int, str],
) -> Row:
    right = next(shape.format(number) for number, what in known.items() if what == meant)
    return stated(
        place, f"reference: {words}", printed, right, right == printed,
        f"The words speak of the {meant}; {printed} is the {stands}.",
    )  # fmt: skip


def _second_order() -> Row:
    return stated(
        "section 4", "reference: second-order linear model", "(20)", "(21)", False,
        f"(20) is the {EQUATIONS[20]}; the second-order model with d = 5 is (18) in letters and "
        "(21) in numbers.",
    )  # fmt: skip


def _caption() -> Row:
    varied = {"Fig. 10": ("q_u = 1", "γ = 0.5"), "Fig. 12": ("q_u = 100", "γ = 0.5")}
    penalties = {settings[0] for settings in varied.values()}
    poles = {settings[1] for settings in varied.values()}
    return stated(
        "section 6.2", "what differs in Figs. 10 to 12", "individual poles γ",
        "individual penalization factors q_u", len(poles) > 1 or len(penalties) == 1,
        "By their captions γ stays at 0.5 and q_u is 1, 5 and 100.",
    )  # fmt: skip
