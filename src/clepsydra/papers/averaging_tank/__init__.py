"""Kolankowski and Piotrowski 2022: an averaging tank with variable filling."""

from clepsydra.papers.document import Document
from clepsydra.papers.printed_table import printed_table

DOCUMENT = Document(
    __name__,
    1,
    "Design of three control algorithms for an averaging tank with variable filling",
    "M. Kolankowski and R. Piotrowski, 2022",
    {
        "model": "The balances and the linear model",
        "closed-loops": "Pairing, decoupler and closed loops in symbols",
        "pi": "Multivariable PI control and its tuning",
        "pid-types": "P, PI and PID, each tuned over each index",
        "lqi": "State and output feedback with integral action",
        "squared-errors": "Optimisation by ISE and ISEG",
        "fuzzy": "Mamdani fuzzy control",
        "operating-range": "Large steps: wind-up or nonlinearity, and what helps",
        "fuzzy-range": "Fuzzy control: large steps and a controller's scan",
        "hardware-in-the-loop": "Hardware in the loop: exported controllers behind a PLC's cards",
    },
)
PRINTED = printed_table(__name__)
