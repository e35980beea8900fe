"""Sections 4 and 5: what the predictor bears, and what the additional pole does."""

from __future__ import annotations

from functools import cache, partial, reduce

import numpy as np
from numpy.polynomial.polynomial import polyadd, polymul, polysub

from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial.two_degree_of_freedom import (
    TwoDegreeOfFreedom,
    assigned,
    two_degree_of_freedom,
)
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.polynomials import factor
from clepsydra.papers.eight_tanks.six_designs import POLES, printed_model, step_run, trends, turns
from clepsydra.papers.figure import Figure
from clepsydra.papers.row import Row, Rows

_SECOND_ORDER = (1.0, 10.0, 100.0, 1e3, 1e4, 1e6)
_INTEGRATOR, _LOAD = 0.1, 0.05
_SAMPLES = 240  # one a minute


def run() -> Found:
    """Return the rows on the predictor and on the second-order polynomial, with a picture."""
    return (_numerator(), *_second_order(), _other_plants(), _picture())


def closed_loop_radius(
    found: TwoDegreeOfFreedom, model: SampledModel, process: SampledModel
) -> float:
    """Return the largest root of a Smith predictor's loop on a process, by polynomials alone.

    K P u = r0 w − Q (y + (B(1) z^-1 − z^-d B) u / A), y = B' u / A', where the primes are of the
    process.
    """
    K, P, Q = (np.array(each, dtype=float) for each in ((1.0, -1.0), found.P, found.Q))
    ahead = np.array([0.0, float(np.sum(model.B))])
    late = np.concatenate([np.zeros(model.delay), model.B])
    behind = np.concatenate([np.zeros(process.delay), process.B])
    product = partial(reduce, polymul)
    inner = polyadd(product([process.A, polysub(ahead, late)]), product([model.A, behind]))
    whole = polyadd(product([K, P, model.A, process.A]), product([Q, inner]))
    return float(np.max(np.abs(np.roots(whole))))


def _numerator() -> Row:
    line = PRINTED["section 4", "transfer function whose numerator is B(1)"]
    return line.remark("that of G_m(z^-1)")


def _second_order() -> Rows:
    runs = [step_run(penalty, ()) for penalty in _SECOND_ORDER]
    alone = ", ".join(str(_turns_on_the_model(penalty)) for penalty in _SECOND_ORDER)
    yield PRINTED["section 5", "second-order polynomial (28)"].remark(
        f"{', '.join(str(run.swings) for run in runs)} swings for q_u = 1, 10, 100, 10³, 10⁴, "
        f"10⁶ on (8); {alone} on (21)",
        samples=_SAMPLES,
    )
    yield PRINTED["section 5", "another pole in (29)"].claimed(
        POLES[2].run.swings == 0,
        f"{POLES[2].run.swings} swings with {POLES[2].label}",
        swings=runs[1].swings,
        others=" and ".join(str(choice.run.swings) for choice in POLES[:2]),
    )


def _turns_on_the_model(penalty: float) -> int:
    """Return the swings of the inflow if (21) is the process too.

    The predictor is exact then, so that u = r0 A/D w with r0 = D(1)/B(1).
    """
    from scipy.signal import lfilter

    model = printed_model()
    D = assigned(factor(penalty), ())
    r0 = D.at_one / float(np.sum(model.B))
    inflow = lfilter(r0 * model.A, D.coefficients, np.ones(_SAMPLES))
    return turns(inflow, 0.02 / model.static_gain)


def _other_plants() -> Row:
    offset = _offset_on_integrator()
    model = SampledModel((0.1,), (-1.05,), 5, 1.0)
    unstable = closed_loop_radius(_placed(model), model, model)
    line = PRINTED["section 1", "integrating and unstable processes"]
    return line.claimed(
        abs(offset) > 1e-3 and unstable > 1.0,
        f"integrating: offset {offset:.3f} under a load of {_LOAD} added to the input; unstable: "
        f"largest root {unstable:.3f}",
        integrator=_INTEGRATOR,
    )


def _placed(model: SampledModel) -> TwoDegreeOfFreedom:
    A, B = tuple(map(float, model.A)), tuple(map(float, model.B))
    return two_degree_of_freedom(A, B, assigned(factor(1.0, model), (0.5,)))


@cache
def _offset_on_integrator() -> float:
    """Return the error that a plain predictor keeps under a load, simulated sample by sample."""
    model = SampledModel((_INTEGRATOR,), (-1.0,), 5, 1.0)
    q, late, samples = list(map(float, _placed(model).Q)), model.delay, 400
    # What was before the start is zero, and stands in front.
    u, ahead, y, predicted = np.zeros((4, late + samples + 1))
    for k in range(late + 1, late + samples):
        predicted[k] = y[k] + ahead[k] - ahead[k - late]
        u[k] = u[k - 1] - sum(q[j] * predicted[k - j] for j in range(len(q)))
        ahead[k + 1] = ahead[k] + _INTEGRATOR * u[k]
        y[k + 1] = y[k] + _INTEGRATOR * (u[k - late] + _LOAD)
    return float(y[late + samples])


def _picture() -> Figure:
    runs = {
        "D of second order, q_u = 10": step_run(10.0, ()),
        "D of second order, q_u = 10⁴": step_run(1e4, ()),
        POLES[2].label: POLES[2].run,
    }
    return Figure(
        "",
        "The second-order polynomial D, and the pole that is added to it",
        trends(runs),
        "Per metre of a setpoint step, on the true chain.",
    )
