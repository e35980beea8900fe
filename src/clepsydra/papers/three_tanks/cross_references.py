"""Cross-references of the text: the number that is printed, and what the words around it mean."""

from __future__ import annotations

from clepsydra.papers.cross_references import wrong_references
from clepsydra.papers.document import Found
from clepsydra.papers.three_tanks import PRINTED

#: Place and the words around, to where that stands of which they speak.
_RIGHT = {
    ("stability analysis", "number of the range of VGM"): "(8)",
    ("stability analysis", "the results are tabulated in"): "Tables 2 and 3",
    ("closed loop of the PID", "the Bode diagram is drawn and is shown in"): "Fig. 13",
    ("conclusion", "The performance summary is given in"): "a table that the document lacks",
    ("conclusion", "The disturbance rejection capability … is evident from"): "Fig. 10",
}


def run() -> Found:
    """Return a row for each wrong reference."""
    yield from wrong_references(PRINTED, _RIGHT)
