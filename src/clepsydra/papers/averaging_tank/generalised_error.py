"""Why PI control is not tuned by ISEG: what the derivative of the step makes of the index."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.continuous_pi import Constants, ContinuousRun, continuous_run
from clepsydra.papers.averaging_tank.pi import BY_HAND
from clepsydra.papers.averaging_tank.step_run import PERIOD, STEPS, WEIGHT
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row

_OUTPUTS = ("C", "V")
#: C' = f_in/V (C_in - C) under PI control with T_i = V/f_in has the time constant T_i/K_p, and
#: ∫ (e² + a ė²) is least, √a ΔC², where that is √a.
_TIME = 10.0
_BY_INDEX = Constants("inflow", "by ISEG", _TIME / math.sqrt(WEIGHT), _TIME, 5.0, 30.0)


def run() -> Found:
    """Return the row on ISEG."""
    return (_generalised(),)


def without_jump(run: ContinuousRun, output: str) -> float:
    """Return ISE + a ∫ (dy/dt)² dt, all of ISEG but the derivative of the step."""
    slopes = np.diff(run.outputs[output]) / np.diff(run.time)
    return run.indices["ISE", output] + WEIGHT * float(slopes**2 @ np.diff(run.time))


def _generalised() -> Row:
    found = {each.tuned: continuous_run(each) for each in (BY_HAND["inflow"], _BY_INDEX)}
    jump = {output: WEIGHT * STEPS[output] ** 2 / PERIOD for output in _OUTPUTS}
    own = {(who, o): without_jump(run, o) for who, run in found.items() for o in _OUTPUTS}
    hand, index = found
    line = PRINTED["section 3.1.3", "ISEG of PID control"].told(
        jump=jump,
        hand=own[hand, "C"],
        index=own[index, "C"],
        gain=_BY_INDEX.gain_c,
        later=found[index].settling("C"),
        sooner=found[hand].settling("C"),
    )
    return line.remark(
        f"C {jump['C'] + own[hand, 'C']:.2f} by hand and {jump['C'] + own[index, 'C']:.2f} by "
        f"ISEG, V {jump['V'] + own[hand, 'V']:.2f}"
    )
