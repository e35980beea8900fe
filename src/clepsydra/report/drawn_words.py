"""What becomes of a controller of a study on drawn plants, in a sentence."""

from __future__ import annotations

import math

from clepsydra.report.quantities import number_text
from clepsydra.studies.result import Candidate


def drawn_words(candidate: Candidate) -> str:
    """Return how much worse it gets on the worst of them; empty where it met none.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.studies.result import DrawnError
    >>> drawn_words(SimpleNamespace(drawn=DrawnError(64, 1.32)))
    'Robustness: on the worst of 64 drawn plants its error is 1.32 times what it is on paper.'
    """
    drawn = candidate.drawn
    if drawn is None or not drawn.draws:
        return ""
    if drawn.unsettled:
        return f"Robustness: it does not settle on {drawn.unsettled} of {drawn.draws} drawn plants."
    if math.isnan(drawn.worst):
        return f"Robustness: it settles on all of {drawn.draws} drawn plants."
    return (
        f"Robustness: on the worst of {drawn.draws} drawn plants its error is "
        f"{number_text(drawn.worst)} times what it is on paper."
    )
