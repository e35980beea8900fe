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
    >>> from clepsydra.design.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> loop = Loop(design_simc(analysis.model, analysis.pairing), analysis.model)
    >>> accuracy_warnings(loop.run_checked(default_scenario(analysis.model)))
    []
    """
    if run.error_estimate is None or run.error_estimate <= _ERROR:
        return []
    return [
        f"Halving the integration step shows that a state may be wrong by {run.error_estimate:.1e} "
        f"of its range, more than the {_ERROR:.0e} aimed at: smaller differences between runs say "
        "nothing; compare with the reference solver."
    ]
