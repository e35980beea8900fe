"""The optimisation by ISE and ISEG: the weights (101a), and why PI control is not tuned by ISEG.

What PI control reaches by ISE is judged in `best_values`. For LQI the document optimises ISEG too
and prints nothing of what came out, so that no row judges that.
"""

from __future__ import annotations

import math

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.continuous_pi import Constants, ContinuousRun, continuous_run
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, beaten, indices_of
from clepsydra.papers.averaging_tank.pi import BY_HAND
from clepsydra.papers.averaging_tank.step_run import PERIOD, STEPS
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row
from clepsydra.scores.iae import WEIGHT

_OUTPUTS = ("C", "V")
#: C' = f_in/V (C_in - C) under PI control with T_i = V/f_in has the time constant T_i/K_p, and
#: ∫ (e² + a ė²) is least, √a ΔC², where that is √a.
_TIME = 10.0
_BY_INDEX = Constants("inflow", "by ISEG", _TIME / math.sqrt(WEIGHT), _TIME, 5.0, 30.0)


def run() -> Found:
    """Return the rows on ISE and ISEG."""
    return (_weights(), _generalised())


def _weights() -> Row:
    """Judge the weights (101a): both ISE beside those of others."""
    q1, _, _, q4 = COLUMNS[3].states
    other = COLUMNS[3]._replace(states=(q1, 0.1, 50.0, q4))
    printed, better = (indices_of(each) for each in (COLUMNS[3], other))
    return beaten(PRINTED["(101a)", "optimal weights"], "ISE", better, printed)


def without_jump(run: ContinuousRun, output: str) -> float:
    """Return ISE + 0.5 ∫ (dy/dt)² dt, all of ISEG but the derivative of the step."""
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
