"""The four-tank laboratory report of the course EL2520: its experiments, one a file."""

from clepsydra.papers.document import Document
from clepsydra.papers.printed_table import printed_table

DOCUMENT = Document(
    __name__,
    5,
    "The four-tank process",
    "J. Feng, Y. F. Yu and Z. Wang, project report of the course EL2520 Control Theory and "
    "Practice, KTH, 2021",
    {
        "modelling": "Linear model, zeros and relative gains",
        "identification": "Gains of the pumps and holes",
        "manual-control": "Levels at constant voltages",
        "decentralised-control": "Decentralised PI control",
        "robust-control": "Glover-McFarlane control",
        "margins": "Margins as designed and in the simulator",
    },
    (
        ("Exercise 4.1.2", "robustness"),
        ("Exercise 4.2.2", "overshoot"),
        ("Exercise 4.2.2", "rise"),
        ("Exercise 4.2.2", "recovery"),
        ("Exercise 4.2.2", "Glover-McFarlane"),
        ("Exercise 4.2.3", "overall performance"),
    ),
)
PRINTED = printed_table(__name__)
