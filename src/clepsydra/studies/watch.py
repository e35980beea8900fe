"""What to watch with a controller that may be used."""

from __future__ import annotations

import re

from clepsydra.scores.score_key import by_signal
from clepsydra.studies.result import Candidate
from clepsydra.studies.warnings.accuracy import accuracy_warnings

#: An overshoot worth watching [% of the step].
_OVERSHOOT = 10.0
#: An error of the simulation that is seen in numbers of three digits [share of a state's range].
_SEEN = 1e-3


def watched(candidate: Candidate) -> tuple[str, ...]:
    r"""Return what to watch with a controller, a sentence each; its standing is told elsewhere.

    A level that averages is judged by the flow that it smooths, so its overshoot is left out. An
    error of the simulation that no figure here shows is no property of the controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> print(*watched(cl.study(plant, [cl.design.amigo(plant)]).best), sep="\n")
    It overshoots a step of the setpoint by 10 %.
    Its rule was slowed 1.22 times, until it was robust.
    """
    run, averaging = candidate.run, candidate.run.process.averaging
    overshoots = by_signal(candidate.scores, "overshoot")
    held = (value for name, value in overshoots.items() if name not in averaging)
    overshoot = max(held, default=0.0)
    said = []
    if overshoot > _OVERSHOOT:
        said.append(f"It overshoots a step of the setpoint by {overshoot:.0f} %.")
    if candidate.controller.slowed > 1.0:
        factor = f"{candidate.controller.slowed:.3g}"
        said.append(f"Its rule was slowed {factor} times, until it was robust.")
    unseen = accuracy_warnings(run) if (run.error_estimate or 0.0) < _SEEN else []
    return (*said, *(_first_clause(words) for words in candidate.warnings if words not in unseen))


def _first_clause(words: str) -> str:
    """Return what a warning is about, without what it means and what to do."""
    return f"{re.split('[;:] ', words)[0].rstrip('.')}."
