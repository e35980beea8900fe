"""Polynomial digital control of eight equal liquid tanks in series, Bobál et al."""

from clepsydra.papers.document import Document
from clepsydra.papers.printed_table import printed_table

DOCUMENT = Document(
    __name__,
    2,
    "Polynomial digital control of a series equal liquid tanks",
    "V. Bobál, S. Talaš, P. Dostál and M. Kubalčík, Tomas Bata University in Zlín",
    {
        "chain": "Equations and numbers of the chain",
        "sampled-equations": "Equations (9), (10) and (12) to (18)",
        "identification": "Least squares and the delay",
        "second-order-model": "The model of second order",
        "polynomials": "Diophantine equations and poles",
        "predictor": "Structure of the predictor",
        "control-courses": "The six experiments",
        "robustness": "Robustness beside a plain PID",
        "cross-references": "References of the text",
    },
    headlines=(
        ("section 7", "low-order model of the chain"),
        ("section 7", "relatively simple controllers"),
        ("section 7", "design without numerical methods"),
        ("section 7", "control quality"),
        ("section 7", "robustness of Figs. 7 to 12"),
        ("section 7", "penalisation of the manipulated variable"),
    ),
)
PRINTED = printed_table(__name__)
