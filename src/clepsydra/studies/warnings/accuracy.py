"""The warning of a run whose integration is not as exact as a study wants it."""

from __future__ import annotations

from clepsydra.loop.run import Run

#: Error estimate above which the reader is told, share of the state's range.
_ERROR = 1e-6


def accuracy_warnings(run: Run) -> list[str]:
    """Return a warning where smaller integration steps might still change a state noticeably.

    Parameters
    ----------
    run : Run
        Without an error estimate there is nothing to tell.

    Examples
    --------
    See `clepsydra.studies.warnings.after.run_warnings`.
    """
    if run.error_estimate is None or run.error_estimate <= _ERROR:
        return []
    error, aim = 100.0 * run.error_estimate, 100.0 * _ERROR
    return [
        f"Halving the integration step shows that a state may be wrong by {error:.2g} % of its "
        f"range, more than the {aim:g} % aimed at: smaller differences between runs say nothing; "
        "compare with the reference solver."
    ]
