"""Which sampling period the document's designs bear."""

from __future__ import annotations

import dataclasses
import math

from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_of
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL, pi_controller
from clepsydra.papers.averaging_tank.step_run import model_of
from clepsydra.papers.averaging_tank.symbols import VARIANTS, Variant, constant_flow
from clepsydra.papers.row import Row

#: A usual cycle of a programmable logic controller [s].
CYCLE = 0.01
_LONGEST, _SHORTEST, _HALVINGS = 10.0, 1e-5, 16
_TUNINGS = ("by hand", "optimal")
_LAWS = ("PI", "LQI")


def sampling_row() -> Row:
    """Return the remark on the sampling period."""
    periods = [
        f"{law} {tuned}, {constant_flow(constant)}: "
        f"{float(f'{1e3 * longest_period(constant, law, tuned):.3g}'):g} ms"
        for constant in VARIANTS
        for law in _LAWS
        for tuned in _TUNINGS
    ]
    return PRINTED["section 5", "sampling"].remark(
        "; ".join(periods),
        reason="No sampling period is printed. Longest at which the linear model under the "
        "sampled law is stable, inputs held, errors summed up to the one before, Q3 of (101a) "
        f"as 10.92: at {1e3 * CYCLE:g} ms, a usual cycle, it holds of those by hand, and fails "
        "of PI optimal, and of LQI optimal with f_out constant.",
    )


def longest_period(constant: Variant, law: str, tuned: str) -> float:
    """Return up to which sampling period a design's loop is stable [s], by halving the interval.

    Examples
    --------
    PI control of V, an integrator, is stable while Kp Δt²/Ti − 2 Kp Δt + 4 > 0, up to
    (2 − √3) s with Kp = 8 1/s and Ti = 2 s:

    >>> abs(longest_period("outflow", "PI", "by hand") - (2 - 3**0.5)) < 1e-4
    True
    """
    place, at_cycle = _TUNINGS.index(tuned), model_of(constant, CYCLE)
    if law == "PI":
        controller = pi_controller((BY_HAND, OPTIMAL)[place][constant], at_cycle)
    else:
        controller = lqi_of(COLUMNS[2 * VARIANTS.index(constant) + place], at_cycle)
    low, high = math.log(_SHORTEST), math.log(_LONGEST)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        model = _sampled(model_of(constant), math.exp(middle))
        is_stable = SampledLoops(controller, model).at(controller.values).is_stable
        low, high = (middle, high) if is_stable else (low, middle)
    return math.exp(low)


def _sampled(model: LinearModel, period: float) -> LinearModel:
    point = operating_point_of(model)
    process = dataclasses.replace(point.process, sampling_period=period)
    return dataclasses.replace(model, point=dataclasses.replace(point, process=process))
