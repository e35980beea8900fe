"""The document's fuzzy controller and tank in NumPy alone, from Tables 2 to 5 and (103)."""

from __future__ import annotations

import numpy as np

#: Table 2: left shoulder N or NL, triangles between, right shoulder P or PL.
_INPUTS = {
    "e_C": (14.0, {"N": (-0.2, 0), "ZO": (-0.08, 0, 0.08), "P": (0, 0.2)}),
    "de_C": (0.025, {"N": (-0.2, 0), "ZO": (-0.2, 0, 0.2), "P": (0, 0.2)}),
    "e_V": (15.0, {"NL": (-0.45, 0), "NS": (-0.1, -0.05, 0), "ZO": (-0.01, 0, 0.01),
                   "PS": (0, 0.05, 0.1), "PL": (0, 0.45)}),
    "de_V": (0.1, {"N": (-1, 0), "ZO": (-0.02, 0, 0.02), "P": (0, 1)}),
}  # fmt: skip
#: Table 3, with 0.8 as the top of LL.
_FLOW = {"ZO": (0.05, 0.2), "S": (0.14, 0.2, 0.26), "M": (0.2, 0.35, 0.6), "LM": (0.5, 0.6, 0.8),
         "LL": (0.6, 0.8)}  # fmt: skip
_INLET = {"ZO": (0, 4.9), "S": (4.5, 5, 5.5), "L": (5.1, 10)}
#: Table 4 (f_in/f_out) and Table 5 (C_in), by the sets N, ZO, P of the derivative.
_VOLUME = {"NL": "ZO/LL ZO/LM ZO/LM", "NS": "S/LM S/M S/M", "ZO": "S/S S/S S/S",
           "PS": "M/S M/S LM/S", "PL": "LM/ZO LM/ZO LL/ZO"}  # fmt: skip
_CONCENTRATION = {"N": "ZO ZO S", "ZO": "S S S", "P": "S L L"}
_ADDED = {"P": "LL", "N": "LL", "ZO": "M"}


def _degree(name, corners, x):
    if len(corners) == 3:
        return np.interp(x, corners, (0.0, 1.0, 0.0))
    rises = name in ("P", "PL", "LL", "L")
    return np.interp(x, corners, (0.0, 1.0) if rises else (1.0, 0.0))


_GRIDS = {"f_in": np.linspace(0, 1, 101), "f_out": np.linspace(0, 1, 101),
          "C_in": np.linspace(0, 25, 101)}  # fmt: skip
_SETS = {
    output: {name: _degree(name, corners, grid) for name, corners in sets.items()}
    for (output, grid), sets in zip(_GRIDS.items(), (_FLOW, _FLOW, _INLET), strict=True)
}


def inferred(values, waiting=("N", "ZO", "P")):
    """f_in, f_out and C_in for errors and their rates: MIN, MAX and centre of gravity.

    `waiting` are the sets of e_C whose rules of (103) ask for a steady V, as printed all.
    """
    degrees = {}
    for name, (gain, sets) in _INPUTS.items():
        x = min(max(gain * values[name], -1.0), 1.0)
        degrees[name] = {each: _degree(each, corners, x) for each, corners in sets.items()}
    fired = []
    for row, cells in _VOLUME.items():
        for column, cell in zip(("N", "ZO", "P"), cells.split(), strict=True):
            strength = min(degrees["e_V"][row], degrees["de_V"][column])
            fired += zip(("f_in", "f_out"), cell.split("/"), (strength, strength), strict=True)
    for row, cells in _CONCENTRATION.items():
        for column, cell in zip(("N", "ZO", "P"), cells.split(), strict=True):
            fired.append(("C_in", cell, min(degrees["e_C"][row], degrees["de_C"][column])))
    for row, cell in _ADDED.items():
        strength = degrees["e_C"][row]
        if row in waiting:
            strength = min(strength, degrees["e_V"]["ZO"], degrees["de_V"]["ZO"])
        fired += [("f_in", cell, strength), ("f_out", cell, strength)]
    moved = []
    for output, grid in _GRIDS.items():
        joined = np.zeros_like(grid)
        for where, cell, strength in fired:
            if where == output and strength > 0.0:
                joined = np.maximum(joined, np.minimum(_SETS[output][cell], strength))
        moved.append(float(joined @ grid / joined.sum()))
    return moved


def stepped(
    sizes, period, horizon, filter_time, waiting=("N", "ZO", "P"), exact=False, at_rest=True
):
    """C and V at the samples, and the moves, after steps of both references from (5, 2).

    The filter of the derivatives is a backward difference, or exact for errors that are held; it
    starts at rest, or at the first errors.
    """
    C, V, target, kept = 5.0, 2.0, (5.0 + sizes[0], 2.0 + sizes[1]), list(sizes)
    kept = [0.0, 0.0] if at_rest else kept
    found = []
    for _ in range(round(horizon / period) + 1):
        errors = target[0] - C, target[1] - V
        over = filter_time if exact else filter_time + period
        rates = [(e - k) / over for e, k in zip(errors, kept, strict=True)]
        follows = -filter_time * np.expm1(-period / filter_time) if exact else period
        kept = [k + follows * rate for k, rate in zip(kept, rates, strict=True)]
        names = ("e_C", "e_V", "de_C", "de_V")
        inflow, outflow, inlet = inferred(dict(zip(names, (*errors, *rates), strict=True)), waiting)
        found.append((C, V, inflow, outflow, inlet))
        # Held inputs: V is a straight line, and C - C_in a power of V or an exponential.
        change = inflow - outflow
        if abs(change) > 1e-9:
            share = (V / (V + change * period)) ** (inflow / change)
        else:
            share = np.exp(-inflow * period / V)
        C, V = inlet + (C - inlet) * share, V + change * period
    return np.array(found).T
