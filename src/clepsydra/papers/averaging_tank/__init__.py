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
        "cross-references": "References, headings and names",
        "closed-loops": "Pairing, decoupler and closed loops in symbols",
        "pi": "Multivariable PI control and its tuning",
        "pi-claims": "What is said of PI control",
        "pid-types": "P, PI and PID, each tuned over each index",
        "generalised-error": "Why PI control is not tuned by ISEG",
        "expanded-system": "Inputs and controllability of the expanded system",
        "lqi": "State and output feedback with integral action",
        "optimal-weights": "Whether the printed weights are optimal",
        "lqi-claims": "What is said of LQI control",
        "fuzzy": "Mamdani fuzzy control",
        "operating-range": "Large steps: wind-up or nonlinearity, and what helps",
        "fuzzy-range": "Fuzzy control: large steps and a controller's scan",
        "actuators": "Actuators and transport delays in the model",
        "hardware-in-the-loop": "Hardware in the loop: exported controllers behind a PLC's cards",
    },
    (
        ("section 4", "PI, settling and rise with f_out constant"),
        ("section 4", "LQI, optimisation"),
        ("section 4", "PI against the others"),
        ("section 5", "fuzzy control, large steps"),
        ("section 5", "large steps"),
        ("section 5", "gain scheduling"),
    ),
)
PRINTED = printed_table(__name__)
