"""Table 1 and equations (2) to (4): what the printed parameters give."""

from __future__ import annotations

import numpy as np
import pint

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.document import Found
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.printed_table import entries
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.feedback_loop import from_rest
from clepsydra.papers.three_tanks.printed_model import (
    DENOMINATOR,
    FLOW,
    LEVELS,
    NUMERATOR,
    companion,
    flows_at,
    linear_model_at,
    printed_model,
    three_tanks,
)
from clepsydra.papers.three_tanks.state_feedback import STEP, settling


def run() -> Found:
    """Return the rows on the model, and the open-loop response."""
    rows = (*_units(), _rest(), *_matrices(), *_transfer_function(), *_controllability())
    return (*rows, *_claims(), _open_loop())


def _units() -> Rows:
    """Judge the units of table 1 by the equations that use them."""
    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    speed = (registry("m^2/s") * registry("m")).dimensionality
    is_speed = speed == (registry("m/s") ** 2).dimensionality
    metres = printed_model().A
    second = linear_model_at(np.array([0.5, 0.0045, 0.4])).A
    third = linear_model_at(np.array([0.5, 0.45, 0.004])).A
    yield PRINTED["Table 1", "unit of g"].stated("m/s²", is_speed)
    of_h2 = PRINTED["Table 1", "unit of h2s"].told(cm=second[0, 0], m=metres[0, 0])
    yield of_h2.stated("m", _rounds_to("A11", second[0, 0]))
    of_h3 = PRINTED["Table 1", "unit of h3s"].told(cm=third[:, 2], m=metres[:, 2])
    yield of_h3.stated("m", _rounds_to("A23", third[1, 2]) and _rounds_to("A33", third[2, 2]))


def _rounds_to(name: str, rate: float) -> bool:
    """Whether an entry of (2) is a rate, but for the last digit."""
    printed = PRINTED["(2)", name].number
    return bool(abs(rate - printed.value) < printed.half_unit)


def _rest() -> Row:
    flows = 1e6 * flows_at(LEVELS)
    return PRINTED["Table 1", "q2s at 0.40 m in tank 3"].compared(float(flows[2]), q=flows)


def _matrices() -> Rows:
    model = printed_model()
    inputs = {f"B{i + 1}": value for i, value in enumerate(model.B[:, 0])}
    yield from PRINTED.compared("(2)", entries("A", model.A) | inputs)


def _transfer_function() -> Rows:
    model = printed_model()
    polynomial = np.poly(model.A)
    gain = NUMERATOR / DENOMINATOR[3]
    rest = np.linalg.solve(companion(), -np.array([0.0, 0.0, 1.0]))
    evidence = (
        f"with it the static gain to x1 is the {gain:.4g} s/m² that the numbers of (3) make, and "
        f"with B3 = 1 {rest[0]:.4g}; x1 is defined as the level of tank 3, so that 0.054 cannot "
        "stand in the output instead",
        abs(rest[0] / gain - 1.0) > 0.5,
    )
    above = PRINTED["rate of x3", "u"].value
    same = (f"the equation of the rate of x3 above it has {above:g}", above == NUMERATOR)
    numerator = model.B[0, 0] * model.A[1, 0] * model.A[2, 1]
    # Three openings, each k/A, of which the first two join two tanks.
    k1, k2, outlet = model.A[0, 1], model.A[1, 2], -model.A[2, 2] - model.A[1, 2]
    square = PRINTED["(3)", "coefficient of s²"]
    cut = PRINTED["(2)", "A22"].value
    rates = [round(float(rate), 4) for rate in (k1, k1 + k2, k2 + outlet)]
    assert abs(sum(rates) - square.value) < 1e-9
    hangs_on = (
        f"With A22 rounded to {-rates[1]:g} 1/s it is {sum(rates):.4f}; with the {cut:g} 1/s of "
        f"(2), where it is cut, {rates[0] - cut + rates[2]:.4f}, as from A unrounded."
    )
    lower = {"coefficient of s": polynomial[2], "constant coefficient": polynomial[3]}
    # Of the companion form x1 = h3, x2 = dh3/dt, x3 = d²h3/dt² of (3).
    last_row = {f"A3{j + 1}": -polynomial[3 - j] for j in range(3)}
    rate = {f"x{j + 1}": -polynomial[3 - j] for j in range(3)} | {"u": numerator}
    yield from PRINTED.compared("(3)", {"numerator": numerator})
    yield square.compared(polynomial[1]).undecided(hangs_on)
    yield from PRINTED.compared("(3)", lower)
    yield from PRINTED.compared("rate of x3", rate)
    yield from PRINTED.compared("(4)", last_row)
    yield PRINTED["(4)", "B3"].compared(NUMERATOR, right_if=[evidence, same])
    yield PRINTED["(4)", "output"].stated("y = [1 0 0] x", bool(abs(rest[2]) > 1e-9))


def _controllability() -> Rows:
    model = printed_model()
    matrix = np.hstack([model.B, model.A @ model.B, model.A @ model.A @ model.B])
    as_printed = np.array(
        [[PRINTED["(2)", f"A{i}{j}"].value for j in (1, 2, 3)] for i in (1, 2, 3)]
    )
    qc11, qc12, qc13, qc22 = PRINTED.numbers("controllability", "Qc11", "Qc12", "Qc13", "Qc22")
    by_print = qc11 * as_printed[:, 0]
    evidence = (
        "its column sums to zero, as tank 1 gives tank 2 what it loses, and has 2.1",
        abs(by_print[0] + by_print[1]) < 1e-9 and round(by_print[1], 1) == qc22,
    )
    squared = as_printed @ by_print
    second = (
        f"the A of (2) and 64.94 of Qc give {squared[0]:.4f}",
        round(squared[0], 2) == 0.13 and round(by_print[0], 1) == -2.1,
    )
    # Both entries follow from one wrong rate, so that neither is a digit lost on the way to us.
    other = -0.04 * qc11, 0.04**2 * qc11 + as_printed[0, 1] * by_print[1]
    one_slip = (
        "-0.04 for the -0.0322 of (2) makes Qc12 and Qc13 as printed",
        round(other[0], 1) == qc12 and round(other[1], 2) == qc13,
    )
    proof = {"Qc12": [evidence, one_slip], "Qc13": [second, one_slip]}
    rank = np.linalg.matrix_rank(matrix)
    place = "controllability"
    yield from (
        PRINTED[place, name].compared(float(value), right_if=proof.get(name, ()))
        for name, value in entries("Qc", matrix).items()
    )
    yield PRINTED[place, "rank"].claimed(rank == 3, f"rank {rank}")


def _claims() -> Rows:
    model, place = printed_model(), "simulation results"
    eigenvalues, tenth = np.linalg.eigvals(model.A).real, 0.1
    start, *rests = (
        find_equilibrium(three_tanks(), inputs={"feed": share * FLOW}).state[2]
        for share in (1.0, 1.0 + tenth, 1.0 - tenth)
    )
    more, less = (100.0 * float(rest / start - 1.0) for rest in rests)
    yield PRINTED[place, "open loop"].claimed(
        bool(np.all(eigenvalues < 0.0)) and abs(more + less) > 0.01 * more,
        f"{', '.join(f'{value:.4f}' for value in sorted(eigenvalues))} 1/s; "
        f"{more:+.1f} and {less:+.1f} %",
    )
    time = np.linspace(0.0, 5000.0, 50001)
    gain = np.linalg.solve(model.A, -model.B)[2, 0]
    assert gain > 1.0 > 1e-4 * gain  # in m and m³/s, in cm and cm³/s
    level = from_rest(model.A, STEP / gain * model.B[:, 0], time)[:, 2]
    yield PRINTED[place, "set point tracking"].remark(
        f"fed in as it is {gain:.0f} times the step; divided by the static gain the step, after "
        f"{settling(time, level):.0f} s"
    )


def _open_loop() -> Figure:
    """Redraw Fig. 4: all levels after a step of the feed of a tenth, linear and nonlinear."""
    from scipy.integrate import solve_ivp

    process = three_tanks()
    start = find_equilibrium(process).state
    time = np.linspace(0.0, 3000.0, 600)
    flow, load = 1.1 * FLOW, np.zeros(len(process.disturbances))
    model = linear_model_at(start)
    tanks = solve_ivp(
        lambda t, x: np.array(process.dynamics(x, flow, load, process.parameter_values)).ravel(),
        (0.0, time[-1]), start, t_eval=time, rtol=1e-8, method="LSODA",
    ).y  # fmt: skip
    linear = solve_ivp(
        lambda t, x: model.A @ x + model.B[:, 0] * (flow - FLOW),
        (0.0, time[-1]), np.zeros(3), t_eval=time, rtol=1e-8, method="LSODA",
    ).y  # fmt: skip
    panels = [
        Panel(f"tank {i + 1}", "level [cm]", (
            Curve("orifice laws", time, 100.0 * tanks[i]),
            Curve("linear model", time, 100.0 * (linear[i] + start[i]), "dashed"),
        ))
        for i in range(3)
    ]  # fmt: skip
    title = "Levels after a rise of the feed by a tenth, from rest at 50 cm³/s"
    return Figure("Fig. 4", title, panels)
