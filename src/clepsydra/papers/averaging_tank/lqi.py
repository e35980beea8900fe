"""Section 3.2 and Table 7: state and output feedback with integral action, and Fig. 8."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.lqi_runs import (
    COLUMNS,
    PRINTED_Q3,
    Weights,
    gains,
    indices_of,
    lqi_run,
)
from clepsydra.papers.averaging_tank.printed_tables import KEYS
from clepsydra.papers.averaging_tank.step_run import (
    STEPS,
    WEIGHT,
    smooth_iseg,
    trend_figure,
)
from clepsydra.papers.document import Found
from clepsydra.papers.printed import Printed, printed_number
from clepsydra.papers.printed_table import entries
from clepsydra.papers.row import Row, Rows, joined

#: The gains between C and C_in, and V and the flow; and the second rows of F and Fi.
_COUPLED, _SECOND_ROW = ("F12", "F21", "Fi12", "Fi21"), ("F21", "F22", "Fi21", "Fi22")


def run() -> Found:
    """Return the rows on LQI control, and Fig. 8."""
    yield from (*_gains(), *_table_7(), *_squared_slopes())
    yield trend_figure(
        "Fig. 8", "Steps of both references under LQI control",
        {column.title: lqi_run(column) for column in COLUMNS}, 4.0,
        "The optimal weights press the settling of V from seconds to a tenth of one.",
    )  # fmt: skip


def _gains() -> Rows:
    hand, best, other, last = (_named(gains(column)) for column in COLUMNS)
    f12 = PRINTED["(97b)", "F12"].value
    square = (
        "Fi12² is Q4/R1 = 10, and F12 beside it asks for it, as F12² = Q2/R1 + 2 Fi12",
        abs(hand["Fi12"] ** 2 - COLUMNS[0].states[3]) < 1e-6
        and abs((f12**2 - COLUMNS[0].states[1]) / 2.0 - hand["Fi12"]) < 2e-4,
    )
    yield from (
        PRINTED["(97b)", name].compared(hand[name], right_if=[square] * (name == "Fi12"))
        for name in _COUPLED
    )
    yield from PRINTED.compared("(98b)", {name: other[name] for name in _COUPLED})
    for column, found in ((COLUMNS[1], best), (COLUMNS[3], last)):
        place = column.place.replace("a", "b")
        for name in ("F12", "Fi12"):
            share = _left_open(column, name)
            line = PRINTED[place, name].told(share=100 * share)
            yield line.compared(found[name], tolerance=share)
        for name in _SECOND_ROW:  # They are garbled.
            right = f"{found[name] + 0.0:.1f}" if abs(found[name]) > 1e-6 else "0"
            yield PRINTED[place, name].stated(right, PRINTED[place, name].text == right)
    yield _third_weight()
    for place, found, names in (
        ("(97b)", hand, "F11, F22, Fi11 and Fi22"),
        ("(98b)", other, "F11, F22, Fi11 and Fi22"),
        ("(100b)", best, "F11 and Fi11"),
        ("(101b)", last, "F11 and Fi11"),
    ):
        largest = max(abs(found[name]) for name in re.findall(r"Fi?\d\d", names))
        yield PRINTED[place, names].compared(largest, zero=1e-6)


def _named(matrix: np.ndarray) -> dict[str, float]:
    """Return [F Fi] by the names of its entries."""
    return {**entries("F", matrix[:, :2]), **entries("Fi", matrix[:, 2:])}


def _left_open(weights: Weights, name: str) -> float:
    """Return what the last printed digits of the weights leave open of a gain, as a share.

    A weight of 1e-6 is printed as a power of ten, and taken as exact.
    """
    gain, share = _named(gains(weights))[name], 0.0
    values = np.array([*weights.states, *weights.inputs])
    for place in np.flatnonzero(values > 1e-6):
        moved = values.copy()
        moved[place] += printed_number(f"{values[place]:g}").half_unit
        other = weights._replace(states=tuple(moved[:4]), inputs=tuple(moved[4:]))
        share += abs(_named(gains(other))[name] / gain - 1.0)
    return share


def _fitting(weights: Weights) -> int:
    """Count the cells of C in the last column of Table 7, beside ISEG, that weights bring out."""
    found = indices_of(weights)
    cells = {i: PRINTED["Table 7", f"{i} of C, {weights.title}"] for i, o in KEYS if o == "C"}
    rows = [cell.compared(found[i, "C"], unprinted="-") for i, cell in cells.items()]
    return sum(row.verdict == "reproduced" for row in rows)


def _third_weight() -> Row:
    """Judge Q3 of (101a) by the cells of C in the last column of Table 7."""
    printed, right = PRINTED_Q3.states[2], COLUMNS[3].states[2]
    tried = (0.1 * printed, printed, 10.0 * printed, right, 10.0 * right)
    fits = {weight: _fitting(COLUMNS[3].with_third(weight)) for weight in tried}
    *others, least = PRINTED_Q3.inputs
    assert _fitting(PRINTED_Q3._replace(inputs=(*others, 0.01 * least))) == 4
    evidence = (
        "with it all four cells of C in Table 7 beside ISEG come out, with the print none; of the "
        "values near it, which agree as well, it has the print's digits. R2 = 1e-8 beside the "
        "print would do it too, but 1e-6 is the least of all weights printed, and four others are "
        "that",
        fits[right] == 4
        and fits[printed] == 0
        and all(n < 2 for w, n in fits.items() if w != right),
    )
    return PRINTED["(101a)", "Q3"].compared(right, right_if=[evidence])


def _table_7() -> Rows:
    for index, output in KEYS:
        for column in COLUMNS:
            line = PRINTED["Table 7", f"{index} of {output}, {column.title}"]
            if index == "IE":
                found = _error_per_step(column, output) * STEPS[output]
            else:
                found = indices_of(column)[index, output]
            digit = f"Its last digit hangs on the solver, which is not printed. {line.note}"
            row = line.compared(found, unprinted=digit)
            if index == "IE" and column is COLUMNS[0]:
                row = row.circular(_step_from(output, line.value))
            elif column is COLUMNS[3] and output == "C":
                row = row.circular("Q3 of (101a) was chosen by the four cells of C here.")
            yield row


def _error_per_step(column: Weights, output: str) -> float:
    """Return IE over the step that makes it."""
    F = _named(gains(column))
    return (1.0 + F["F21"]) / F["Fi21"] if output == "C" else F["F12"] / F["Fi12"]


def _step_from(output: str, error: float) -> str:
    """Tell how the step of an output, which is not printed, follows from its first IE."""
    return (
        f"The step of {output} is not printed; it was solved from this cell, as "
        f"{error / _error_per_step(COLUMNS[0], output):.4f}, and taken as {STEPS[output]:g}."
    )


def _squared_slopes() -> Rows:
    """ISEG: one time, solved from the first cell, is nearly all of every cell."""
    first = _iseg("C", COLUMNS[0]).value - smooth_iseg(lqi_run(COLUMNS[0]), "C")
    time = WEIGHT * STEPS["C"] ** 2 / first
    for output in ("C", "V"):
        share = WEIGHT * STEPS[output] ** 2 / time
        left = _iseg("C", COLUMNS[0]).number.half_unit * (STEPS[output] / STEPS["C"]) ** 2
        for column in COLUMNS:
            line, smooth = _iseg(output, column), smooth_iseg(lqi_run(column), output)
            is_solved_from = output == "C" and column is COLUMNS[0]
            where = (
                "this cell"
                if is_solved_from
                else f"the first cell alone, whose last digit leaves {left:.1g} of it open"
            )
            # Of the cell that the time was solved from it says nothing.
            in_print = "" if is_solved_from else f", and in print {line.value - share:.3f}"
            why = (
                f"{share:.3f} of it is the derivative of the step itself, taken over "
                f"{1e4 * time:.5f}e-4 s, solved from {where}; the control's own part is "
                f"{smooth:.4f}{in_print}. {line.note}"
            )
            slope = "How the derivative of the error was taken is not printed."
            row = replace(line, note=why).compared(share + smooth, unprinted=joined(slope, why))
            yield (row.circular("") if is_solved_from else row)


def _iseg(output: str, column: Weights) -> Printed:
    return PRINTED["Table 7", f"ISEG of {output}, {column.title}"]
