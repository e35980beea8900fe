"""The caveat of a run whose integration is not as exact as a study wants it."""

from __future__ import annotations

from clepsydra.loop.run import Run
from clepsydra.studies.warnings.caveat import Caveat

#: Error estimate above which the reader is told, share of the state's range.
_ERROR = 1e-6
#: And that is seen in figures of three digits.
_SEEN = 1e-3


def accuracy_caveats(run: Run) -> list[Caveat]:
    """Return a caveat where smaller integration steps might still change a state noticeably.

    Parameters
    ----------
    run : Run
        Without an error estimate there is nothing to tell.
    """
    if run.error_estimate is None or run.error_estimate <= _ERROR:
        return []
    error, aim = 100.0 * run.error_estimate, 100.0 * _ERROR
    words = (
        f"Halving the integration step shows that a state may be wrong by {error:.2g} % of its "
        f"range, more than the {aim:g} % aimed at: smaller differences between runs say nothing; "
        "compare with the reference solver."
    )
    return [Caveat(words, "accuracy", error, seen=run.error_estimate >= _SEEN)]
