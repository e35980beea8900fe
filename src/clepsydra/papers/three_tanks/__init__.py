"""Nagammai and Latha 2016: three coupled tanks."""

from clepsydra.papers.document import Document
from clepsydra.papers.printed_table import printed_table

DOCUMENT = Document(
    __name__,
    4,
    "Design of optimal controllers for a three tank process",
    "S. Nagammai and S. Latha, Journal of Scientific and Innovative Research 5(2), 2016, 65-70",
    {
        "letters": "The linear model, in letters",
        "linear-model": "The levels at rest and the linear model",
        "pid-design": "PID control by Ziegler and Nichols",
        "state-feedback": "State feedback with a precompensator",
        "promises": "What state feedback is to do",
        "linear-quadratic": "Linear-quadratic control",
        "weights": "What Q and R are to do",
        "equations": "Equations (5) to (7), in symbols",
        "conclusion": "The conclusion, on the linear model",
        "cross-references": "Cross-references",
        "servo-and-load": "Setpoint and load, with a real pump",
    },
    [
        ("abstract", "performance"),
        ("abstract", "FSFB over LQC"),
        ("abstract", "VGM of LQC and FSFB"),
        ("conclusion", "settling time"),
        ("conclusion", "overshoot"),
        ("conclusion", "desired specifications"),
        ("conclusion", "settling time, ISE and IAE"),
        ("conclusion", "disturbance"),
    ],
)
PRINTED = printed_table(__name__)
