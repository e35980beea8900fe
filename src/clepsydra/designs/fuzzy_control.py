"""Fuzzy PI control for each loop: the standard table of rules, with the gains of a linear PI."""

from __future__ import annotations

from functools import cache
from itertools import product

import casadi as ca
import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.fuzzy.inference import surface
from clepsydra.controllers.fuzzy.law import FAMILY, fuzzy_law
from clepsydra.controllers.fuzzy.membership import (
    Membership,
    left_shoulder,
    right_shoulder,
    triangle,
)
from clepsydra.controllers.fuzzy.rule import All, Is, Rule
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.controllers.fuzzy.variables import FuzzyInput, FuzzyOutput
from clepsydra.designs.arguments.argument import number
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.design import Studied, design
from clepsydra.designs.loops.closed_loop_time import CLOSED_LOOP_TIME
from clepsydra.designs.loops.pairing import Pairing
from clepsydra.designs.request import in_shown_unit
from clepsydra.designs.simc import design_simc
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

SETS = ("NL", "NS", "ZO", "PS", "PL")
#: The error that is "large", as a share of the measurement's range: from the middle to an end.
_LARGE_ERROR = 0.5


def standard_rules(error: str, change: str, output: str) -> tuple[Rule, ...]:
    """Return MacVicar-Whelan's table with five sets: the output is the sum of both inputs.

    Parameters
    ----------
    error, change, output : str
        Linguistic variables, each with the sets NL, NS, ZO, PS and PL.

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
    last = len(SETS) - 1
    rules = list[Rule]()
    for i, j in product(range(len(SETS)), repeat=2):
        condition = All((Is(error, SETS[i]), Is(change, SETS[j])))
        sum_of_both = min(max(i + j - last // 2, 0), last)
        rules.append(Rule(f"R{len(rules) + 1}", condition, (Is(output, SETS[sum_of_both]),)))
    return tuple(rules)


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


@cache
def standard_system(points: int = 101) -> FuzzySystem:
    """Return the standard table of a loop: from error and change of a signal to a rate.

    Examples
    --------
    >>> system = standard_system()
    >>> len(system.rules), [variable.name for variable in system.inputs]
    (25, ['error', 'change'])
    """
    names = "error", "change", "rate"
    error, change, rate = (LinguisticVariable(n, -1.0, 1.0, standard_sets()) for n in names)
    return FuzzySystem((error, change), (rate,), standard_rules(*names), points)


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


@design(
    "fuzzy_pi",
    "fuzzy PI by the standard table",
    Studied(270, "Fuzzy PI"),
    keys=(
        number(
            "largest_error",
            "a share of the range",
            "error at which the rules end, a share of the range",
            example="0.5",
        ),
        CLOSED_LOOP_TIME,
    ),
    method="fuzzy PI",
)
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
    largest_error : float
        E as a share of the measurement's range.
    closed_loop_time_constant : float, optional
        Of the linear design, see `designs.simc` [s].

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
    linear = design_simc(model, pairing, closed_loop_time_constant=closed_loop_time_constant)
    point = operating_point_of(model)
    process = point.process
    measured = [process.signal(name) for name in linear.measurements]
    moved = [process.signal(name) for name in linear.manipulated]
    law = fuzzy_law(
        standard_system(),
        [FuzzyInput(what, y) for y in measured for what in ("error", "measurement_rate")],
        [FuzzyOutput(u, "increment") for u in moved],
        loops=linear.measurements,
        name="fuzzy_pi",
    )
    by_error, by_change = slopes_at_rest()
    values = numbers_at(point, law.parameters)
    for y, u in zip(measured, moved, strict=True):
        gain = linear.values[path(y, "proportional_gain")]
        time = linear.values[path(y, "integral_time")]
        scale = 1.0 / (largest_error * y.span)
        values |= {
            path(y, "error.gain"): scale,
            path(y, "change.gain"): -scale * time * by_error / by_change,
            path(u, "output_gain"): gain / (time * scale * by_error),
        }
    large = ", ".join(f"{in_shown_unit(y, largest_error * y.span)} of {y.name}" for y in measured)
    return controller_at(
        point,
        "Fuzzy PI",
        FAMILY,
        law,
        values,
        structure=Complexity.ADVANCED_LOOPS,
        design=(
            "Incremental fuzzy PI by MacVicar-Whelan's table of 25 rules for each loop, an error "
            f"of {large} being large; at rest its gains are those of SIMC. {linear.design}"
        ),
        notes=(
            *linear.notes,
            "Its proportional part acts on the measurement alone, and its gain falls as the error "
            "grows: a step of the setpoint takes longer than with linear PI control.",
        ),
    )
