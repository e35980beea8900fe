"""Newton's method for an equilibrium as a step law: an evaluation of the equations a sample."""

from __future__ import annotations

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, elements
from clepsydra.linear.equilibrium_search import INSIDE, EquilibriumSearch
from clepsydra.program.step_law import StepLaw

#: Where the search is, its last step, the sizes of the equations there, how far off it is, how much
#: of the step is tried, and whether it has ended: 1 where it is at rest, -1 where it got stuck.
UNKNOWN, STEP, SIZE, OFF, SHARE, ENDED = "unknown", "step", "size", "off", "share", "ended"
#: Newton's step at the end, beside an unknown: what is wrong after it is about its square.
_SMALL = 1e-8
#: What a step has to gain, and the share of it below which the search is stuck; as in
#: `EquilibriumSearch`.
_GAIN, _LEAST_SHARE = 1e-4, 0.5**33
_FAR_OFF = 1e300


def newton_step(search: EquilibriumSearch) -> StepLaw:
    """Return the search as a law without inputs; its parameters are those of the process.

    Its state is `UNKNOWN`, `STEP` and `SIZE` with the place of each unknown, and `OFF`, `SHARE` and
    `ENDED`; behind the parameters of the process come its disturbances. The equations, the scaling
    of the unknowns and the damping are those of `EquilibriumSearch`, but for the step of a singular
    matrix, at which it gets stuck.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.equilibrium_request import read_request
    >>> process = cl.load("three-tanks").process
    >>> law = newton_step(EquilibriumSearch(process, read_request(process, None, None, None)))
    >>> [signal.name for signal in law.state][-3:]
    ['off', 'share', 'ended']
    """
    process, count = search.process, len(search.spans)
    groups = [ca.SX.sym(name, count) for name in (UNKNOWN, STEP, SIZE)]
    off, share, ended = (ca.SX.sym(name) for name in (OFF, SHARE, ENDED))
    unknown, step, size = groups
    p = ca.SX.sym("p", len(process.parameters))
    d = ca.SX.sym("d", len(process.disturbances))
    tried = unknown + share * step
    residuals, jacobian = _equations(search, tried, d, p)
    gained = ca.norm_2(residuals / size) < (1.0 - _GAIN * share) * off
    sizes = ca.vertcat(*(ca.mmax(ca.fabs(jacobian[row, :])) for row in range(count)))
    sizes = ca.if_else(sizes > 0.0, sizes, 1.0)
    newton = ca.solve(jacobian, -residuals)
    small = ca.SX(1)
    for k in range(count):
        near = ca.fabs(newton[k]) <= _SMALL * ca.fmax(1.0, ca.fabs(tried[k]))
        small = ca.logic_and(small, near)
    at_rest = ca.logic_and(gained, small)
    moved = ca.if_else(gained, ca.if_else(small, tried + newton, tried), unknown)
    stuck = ca.logic_and(ca.logic_not(gained), share < 2.0 * _LEAST_SHARE)
    following = ca.vertcat(
        moved,
        ca.if_else(gained, newton, step),
        ca.if_else(gained, sizes, size),
        ca.if_else(gained, ca.norm_2(residuals / sizes), off),
        ca.if_else(gained, 1.0, share / 2.0),
        ca.if_else(at_rest, 1.0, ca.if_else(stuck, -1.0, 0.0)),
    )
    state = ca.vertcat(*groups, off, share, ended)
    following = ca.if_else(ended == 0.0, following, state)
    none = ca.SX(0, 1)
    function = ca.Function("newton_step", [state, none, ca.vertcat(p, d)], [following, none, none])
    starts = {UNKNOWN: 0.0, STEP: 0.0, SIZE: 1.0}
    signals = [Signal(n, initial=starts[g]) for g in starts for n in elements(g, count)]
    signals += [Signal(OFF, initial=_FAR_OFF), Signal(SHARE, initial=1.0), Signal(ENDED)]
    numbers = (*process.parameters, *process.disturbances)
    return StepLaw("newton_step", (), numbers, tuple(signals), (), (), function)


def _equations(search: EquilibriumSearch, tried: ca.SX, d: ca.SX, p: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the residuals and their Jacobian, continued in straight lines beyond the ranges."""
    process, request = search.process, search.request
    states, count = len(process.state), len(search.spans)
    inside = ca.SX.sym("inside", count)
    scaled = [inside[k] ** 2 if search.floored[k] else inside[k] for k in range(count)]
    values = [float(search.spans[k]) * each for k, each in enumerate(scaled)]
    state = ca.vertcat(*(float(search.origins[k]) + values[k] for k in range(states)))
    inputs = [ca.SX(float(value)) for value in request.inputs]
    for place, value in zip(request.free_inputs, values[states:], strict=True):
        inputs[place] = value
    shown = process.measure(state, p)
    targets = zip(request.outputs, request.targets.tolist(), strict=True)
    asked = [shown[row] - target for row, target in targets]
    residuals = ca.vertcat(process.dynamics(state, ca.vertcat(*inputs), d, p), *asked)
    jacobian = ca.jacobian(residuals, inside)
    held = ca.vertcat(*(_held(search, k, tried[k]) for k in range(count)))
    at = ca.Function("equations", [inside, d, p], [residuals, jacobian])
    residuals, jacobian = at(held, d, p)
    return residuals + ca.mtimes(jacobian, tried - held), jacobian


def _held(search: EquilibriumSearch, place: int, tried: ca.SX) -> ca.SX:
    """Return an unknown within the range in which the equations hold."""
    held, low, high = tried, search.least[place], search.most[place]
    if np.isfinite(search.continued[place]):
        held = ca.fmax(held, float(search.continued[place]))
    for beyond, end in ((held < low, low + INSIDE), (held > high, high - INSIDE)):
        if np.isfinite(end):
            held = ca.if_else(beyond, float(end), held)
    return held
