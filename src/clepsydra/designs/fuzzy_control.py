"""Fuzzy PI control for each loop: the standard table of rules, with the gains of a linear PI."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import casadi as ca
import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.inference import surface
from clepsydra.controllers.fuzzy.kinds import FuzzyInput, FuzzyOutput
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.controllers.fuzzy.membership import (
    Membership,
    left_shoulder,
    right_shoulder,
    triangle,
)
from clepsydra.controllers.fuzzy.rule import Rule, rule_table
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.designed_values import designed_values
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.request import in_shown_unit, positive_number
from clepsydra.designs.simc import design_simc
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

METHOD = "fuzzy PI"
SETS = ("NL", "NS", "ZO", "PS", "PL")
#: The error that is "large", as a share of the measurement's range: from the middle to an end.
_LARGE_ERROR = 0.5


def standard_rules(error: str, change: str, output: str, prefix: str = "R") -> tuple[Rule, ...]:
    """Return MacVicar-Whelan's table with five sets: the output is the sum of both inputs.

    Parameters
    ----------
    error, change, output : str
        Linguistic variables, each with the sets NL, NS, ZO, PS and PL.
    prefix : str
        Of the rules' names.

    References
    ----------
    P. J. MacVicar-Whelan, Fuzzy sets for man-machine interaction, International Journal of
    Man-Machine Studies 8(6), 1976, 687-697.

    Examples
    --------
    >>> rules = standard_rules("e", "de", "u")
    >>> len(rules), str(rules[0]), str(rules[7])
    (25, 'if e is NL and de is NL then u is NL', 'if e is NS and de is ZO then u is NS')
    """
    middle = len(SETS) // 2
    cells = [
        [{output: SETS[int(np.clip(i + j - middle, 0, len(SETS) - 1))]} for j in range(len(SETS))]
        for i in range(len(SETS))
    ]
    return rule_table(prefix, (error, SETS), (change, SETS), cells)


def standard_sets() -> dict[str, Membership]:
    """Return five evenly spaced sets over −1 to 1, of which two meet at a half.

    Examples
    --------
    >>> [float(each.degrees(0.25)) for each in standard_sets().values()]
    [0.0, 0.0, 0.5, 0.5, 0.0]
    """
    return {
        "NL": left_shoulder(-1.0, -0.5),
        "NS": triangle(-1.0, -0.5, 0.0),
        "ZO": triangle(-0.5, 0.0, 0.5),
        "PS": triangle(0.0, 0.5, 1.0),
        "PL": right_shoulder(0.5, 1.0),
    }


def standard_system(
    loops: Sequence[tuple[str, str]] = (("level", "pump"),), points: int = 101
) -> FuzzySystem:
    """Return the standard table for some loops: error and change of one signal, rate of another.

    Examples
    --------
    >>> system = standard_system([("level_1", "pump_1"), ("level_2", "pump_2")])
    >>> len(system.rules), [variable.name for variable in system.inputs][:3]
    (50, ['level_1.error', 'level_1.change', 'level_2.error'])
    """
    sets, rules = standard_sets(), list[Rule]()
    inputs, outputs = list[LinguisticVariable](), list[LinguisticVariable]()
    for measured, moved in loops:
        names = path(measured, "error"), path(measured, "change"), path(moved, "rate")
        *read, rate = (LinguisticVariable(name, -1.0, 1.0, sets) for name in names)
        inputs += read
        outputs.append(rate)
        rules += standard_rules(*names, path(measured, "R"))
    return FuzzySystem(tuple(inputs), tuple(outputs), tuple(rules), points)


@cache
def slopes_at_rest() -> tuple[float, float]:
    """Return how steep the standard table's surface is at its origin, by both inputs.

    Examples
    --------
    >>> [round(slope, 3) for slope in slopes_at_rest()]
    [1.48, 1.48]
    """
    x = ca.SX.sym("x", 2)
    slope = ca.Function("slope", [x], [ca.jacobian(surface(standard_system())(x)[0], x)])
    by_error, by_change = np.array(slope([0.0, 0.0])).ravel()
    return float(by_error), float(by_change)


def design_fuzzy_pi(
    model: LinearModel,
    pairing: Pairing | None = None,
    *,
    largest_error: float = _LARGE_ERROR,
    closed_loop_time_constant: float | None = None,
) -> Controller:
    """Design an incremental fuzzy PI controller for each pair, from SIMC's linear one.

    Each loop moves its input by ``du/dt = g f(k_e e, −k_c dy/dt)`` with f the surface of the
    standard table (`standard_system`), whose slopes at the origin are s_e and s_c. Near the
    setpoint it is the PI controller K e/Ti − K dy/dt::

        k_e = 1/E,   k_c = k_e Ti s_e/s_c,   g = K/(Ti k_e s_e)

    so that the linear model at rest is that of the linear design, and so are the margins. Both
    inputs together, and larger ones, count for less. The proportional part acts on the
    measurement alone, as in PI control with a setpoint weight of 0: the rate of a step would be
    cut off. So it is slower than the linear controller that it comes from.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input), or mapping, optional
        The one that the relative gains suggest if left out.
    largest_error : float
        E as a share of the measurement's range.
    closed_loop_time_constant : float, optional
        Of the linear design, see `designs.simc` [s].

    Returns
    -------
    Controller

    Raises
    ------
    NotApplicable
        SIMC is not applicable, or a gain is outside of what a controller takes.
    InputError
        The model has no operating point, the pairing is none of the model, or a number is not
        above zero.

    References
    ----------
    J. Jantzen, Foundations of Fuzzy Control, Wiley 2007 (the fuzzy incremental
    controller and its gains from a linear one); S. Skogestad, Journal of Process Control 13(4),
    2003, 291-309, doi 10.1016/S0959-1524(02)00062-8.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> controller = design_fuzzy_pi(analysis.model, analysis.pairing)
    >>> controller.family, controller.values["level_1.error.gain"]
    ('fuzzy', 0.2)
    """
    share = positive_number(
        f"{METHOD}, largest_error", largest_error, "a share of the range above 0",
        "0.5 is half of the range",
    )  # fmt: skip
    try:
        linear = design_simc(model, pairing, closed_loop_time_constant=closed_loop_time_constant)
    except NotApplicable as refusal:
        raise NotApplicable(METHOD, refusal.reason) from None
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    measured = [process.signal(name) for name in linear.measurements]
    moved = [process.signal(name) for name in linear.manipulated]
    law = fuzzy_law(
        measured,
        moved,
        standard_system(list(zip(linear.measurements, linear.manipulated, strict=True))),
        [FuzzyInput(w, y) for y in linear.measurements for w in ("error", "measurement_rate")],
        [FuzzyOutput("increment")] * len(moved),
        name="fuzzy_pi",
    )
    by_error, by_change = slopes_at_rest()
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    for y, u in zip(measured, moved, strict=True):
        gain = linear.values[path(y, "proportional_gain")]
        time = linear.values[path(y, "integral_time")]
        scale = 1.0 / (share * y.span)
        values |= {
            path(y, "error.gain"): scale,
            path(y, "change.gain"): -scale * time * by_error / by_change,
            path(u, "output_gain"): gain / (time * scale * by_error),
            path(u, "low_limit"): u.low,
            path(u, "high_limit"): u.high,
        }
    values = designed_values(law, values, operating_point_of(model), METHOD)
    inputs = {path(y, what): at[y.name] for y in measured for what in ("sp", "pv")}
    inputs |= {path(u, "tracking"): at[u.name] for u in moved}
    large = ", ".join(f"{in_shown_unit(y, share * y.span)} of {y.name}" for y in measured)
    return Controller(
        name="Fuzzy PI",
        family=FAMILY,
        design=(
            "Incremental fuzzy PI by MacVicar-Whelan's table of 25 rules for each loop, an error "
            f"of {large} being large; at rest its gains are those of SIMC. {linear.design}"
        ),
        law=law,
        values=values,
        initial_state=state_at_rest(law, values, inputs),
        measurements=linear.measurements,
        setpoints=linear.setpoints,
        manipulated=linear.manipulated,
        notes=(
            *linear.notes,
            "Its proportional part acts on the measurement alone, and its gain falls as the error "
            "grows: a step of the setpoint takes longer than with linear PI control.",
        ),
    )
