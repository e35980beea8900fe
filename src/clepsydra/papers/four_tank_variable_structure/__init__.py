"""Four tanks with input constraint under variable-structure PID, Wang and Han 2018."""

from clepsydra.papers.document import Document
from clepsydra.papers.printed_table import printed_table

DOCUMENT = Document(
    __name__,
    3,
    "Variable structure PID control of four-tank system with input constraint",
    "Wang Chen and Han Guangxin, New Materials and Intelligent Manufacturing, 2018, "
    "363-366, doi 10.26480/icnmim.01.2018.363.366",
    {
        "linearisation": "Feedback linearisation, in symbols",
        "filling": "Filling the tanks, conventional and variable structure",
        "pump-limits": "Pump limits from 4 to 20 V",
        "nominal-input": "How far u_n of (14) stands from the range of the pumps",
        "alpha": "The choice of α",
        "robustness": "Pumps and outlets other than assumed",
        "internal": "The non-minimum-phase trap",
    },
    headlines=(
        ("section 5", "speed of the response"),
        ("section 5", "overshoot, variable-structure PID"),
        ("section 5", "time of the pumps at a limit"),
        ("section 5", "energy of a filling"),
        ("section 6", "worst overshoot and settling time"),
        ("section 4, feature (2)", "settling time of h1 over α"),
    ),
)
PRINTED = printed_table(__name__)
