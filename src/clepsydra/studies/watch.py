"""What to watch with a controller that may be used."""

from __future__ import annotations

import re

from clepsydra.scores.score_key import by_signal
from clepsydra.studies.result import Candidate

#: An overshoot worth watching [% of the step].
_OVERSHOOT = 10.0


def watched(candidate: Candidate) -> tuple[str, ...]:
    r"""Return what to watch with a controller, a sentence each; its standing is told elsewhere.

    A level that averages is judged by the flow that it smooths, so its overshoot is left out. What
    simulation and scenario leave open is no property of the controller: see `Candidate.caveats`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> print(*watched(cl.study(plant, [cl.design.amigo(plant)]).best), sep="\n")
    It overshoots a step of the setpoint by 10 %.
    Its rule was slowed 1.22 times, until it was robust.
    """
    averaging = candidate.run.process.averaging
    overshoots = by_signal(candidate.scores, "overshoot")
    held = (value for name, value in overshoots.items() if name not in averaging)
    overshoot = max(held, default=0.0)
    said = []
    if overshoot > _OVERSHOOT:
        said.append(f"It overshoots a step of the setpoint by {overshoot:.0f} %.")
    if candidate.controller.slowed > 1.0:
        factor = f"{candidate.controller.slowed:.3g}"
        said.append(f"Its rule was slowed {factor} times, until it was robust.")
    return (*said, *map(first_clause, candidate.warnings))


def first_clause(words: str) -> str:
    """Return what a warning is about, without what it means and what to do.

    Examples
    --------
    >>> first_clause("pump_1 winds up: its integral has no anti-windup; choose another form.")
    'pump_1 winds up.'
    """
    return f"{re.split('[;:] ', words)[0].rstrip('.')}."
