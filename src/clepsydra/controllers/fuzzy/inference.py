"""Inference: from crisp inputs by degrees, rules and sets to the centroid of each output."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import casadi as ca
import numpy as np

from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.fuzzy.rule import firing
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable, concluded_sets
from clepsydra.program.counted_loop import counted_loop

#: Way of a difference quotient, as a share of an input's range; the cube root of rounding.
_WAY = 1e-5


class Centroid(NamedTuple):
    """The crisp value of an output, and whether any rule fired for it.

    Parameters
    ----------
    value : casadi.SX
        Within the output's range; its middle where no rule fires.
    fires : casadi.SX

    Examples
    --------
    >>> bool(Centroid(ca.DM(0.5), ca.DM(1)).fires)
    True
    """

    value: ca.SX
    fires: ca.SX


class _Stretch(NamedTuple):
    """Neighbouring points at which the same sets are above zero, and those sets' degrees."""

    first: int
    stop: int
    degrees: dict[str, np.ndarray]


def infer(system: FuzzySystem, values: Mapping[str, ca.SX]) -> dict[str, Centroid]:
    """Return each output's centroid.

    With w(s) the largest firing of the rules that conclude set s, μ(y) = max over s of
    min(w(s), μ_s(y)) and Σ over the points y of the output's range, the centroid is
    Σ y μ(y) / Σ μ(y). The rules of one set are joined first: max min(w, μ_s) = min(max w, μ_s).

    Each stretch of points at which the same sets are above zero is a counted loop over those
    sets alone, the others add nothing to the largest, so no bit of the sums changes.

    Parameters
    ----------
    system : FuzzySystem
    values : mapping
        Input to its value, clipped to the range here.

    References
    ----------
    E. H. Mamdani, Application of fuzzy algorithms for control of simple dynamic plant,
    Proceedings of the IEE 121(12), 1974, 1585-1588, doi 10.1049/piee.1974.0328.

    Examples
    --------
    >>> from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
    >>> from clepsydra.controllers.fuzzy.rule import parse_rule
    >>> halves = {"N": left_shoulder(-1.0, 1.0), "P": right_shoulder(-1.0, 1.0)}
    >>> error, move = (LinguisticVariable(name, -1.0, 1.0, halves) for name in ("e", "u"))
    >>> rules = tuple(parse_rule(s, f"if e is {s} then u is {s}") for s in halves)
    >>> system = FuzzySystem((error,), (move,), rules, points=3)
    >>> found = infer(system, {"e": ca.SX(1.0)})["u"]  # degrees 0, 1/2 and 1 at -1, 0 and 1
    >>> round(float(ca.evalf(found.value)), 6)
    0.666667
    """
    degrees: dict[tuple[str, str], ca.SX] = {}
    for variable in system.inputs:
        clipped = limit(values[variable.name], ca.SX(variable.low), ca.SX(variable.high))
        for name, member in variable.sets.items():
            degrees[variable.name, name] = member.expression(clipped)
    strengths = {rule: firing(rule.condition, degrees, ca.fmin, ca.fmax) for rule in system.rules}
    found = {}
    for output in system.outputs:
        heights: dict[str, ca.SX] = {}
        for name, rules in concluded_sets(system.rules, output.name).items():
            height = strengths[rules[0]]
            for rule in rules[1:]:
                height = ca.fmax(height, strengths[rule])
            heights[name] = height
        found[output.name] = _centroid(system, output, heights)
    return found


def _centroid(
    system: FuzzySystem, output: LinguisticVariable, heights: dict[str, ca.SX]
) -> Centroid:
    points = system.points_of(output)
    sums = ca.SX.zeros(2)
    for stretch in _stretches(points, output, heights):
        sums = _summed(output.name, stretch, points, heights, sums)
    moment, area = sums[0], sums[1]
    fires = area > 0
    middle = (output.low + output.high) / 2.0
    return Centroid(ca.if_else(fires, moment / ca.if_else(fires, area, 1), middle), fires)


def _stretches(
    points: np.ndarray, output: LinguisticVariable, heights: Mapping[str, ca.SX]
) -> Iterator[_Stretch]:
    found = {name: d for name, d in output.degrees(points).items() if name in heights}
    above = np.array([degrees > 0.0 for degrees in found.values()])
    changes = np.flatnonzero((above[:, 1:] != above[:, :-1]).any(axis=0)) + 1
    for first, stop in zip([0, *changes], [*changes, len(points)], strict=True):
        here = {name: d[first:stop] for name, d in found.items() if d[first] > 0.0}
        if here:
            yield _Stretch(int(first), int(stop), here)


def _summed(
    output: str,
    stretch: _Stretch,
    points: np.ndarray,
    heights: Mapping[str, ca.SX],
    sums: ca.SX,
) -> ca.SX:
    """Return Σ y μ(y) and Σ μ(y) with those of a stretch added, by a counted loop."""
    label = output.replace(".", "_")
    names = list(stretch.degrees)
    # A height is at most 1: where a set is 1 all along, the height alone is the smaller.
    clipping = [name for name in names if np.any(stretch.degrees[name] != 1.0)]
    tables = [points[stretch.first : stretch.stop], *(stretch.degrees[n] for n in clipping)]
    row, carried = ca.SX.sym("row", len(tables)), ca.SX.sym("sums", 2)
    held = ca.SX.sym("heights", len(names))
    clipped = [
        ca.fmin(held[place], row[1 + clipping.index(name)]) if name in clipping else held[place]
        for place, name in enumerate(names)
    ]
    largest = clipped[0]
    for degree in clipped[1:]:
        largest = ca.fmax(largest, degree)
    turn = ca.Function(
        f"point_of_{label}",
        [row, carried, held],
        [ca.vertcat(carried[0] + row[0] * largest, carried[1] + largest)],
    )
    return counted_loop(
        f"{label}_from_{stretch.first}",
        stretch.stop - stretch.first,
        turn,
        carried=sums,
        tables=[list(map(float, table)) for table in tables],
        invariants=ca.vertcat(*[heights[name] for name in names]),
    )


def surface(system: FuzzySystem) -> ca.Function:
    """Return the centroids as a function of the crisp inputs.

    Its derivatives are central differences over a hundred-thousandth of each range: where the
    inputs are zero, the sets of most controllers meet in corners, at which the derivative of the
    equations as they stand has no meaning. The slope there is the mean of those on both sides.

    Parameters
    ----------
    system : FuzzySystem

    Returns
    -------
    casadi.Function
        (inputs [m]) → (centroids [q], whether any rule fires [q]), in the order of the system.

    Examples
    --------
    >>> from clepsydra.controllers.fuzzy.membership import triangle, left_shoulder, right_shoulder
    >>> from clepsydra.controllers.fuzzy.rule import parse_rule
    >>> sets = {"N": left_shoulder(-1.0, 0.0), "Z": triangle(-1.0, 0.0, 1.0),
    ...         "P": right_shoulder(0.0, 1.0)}
    >>> error, move = (LinguisticVariable(name, -1.0, 1.0, sets) for name in ("e", "u"))
    >>> rules = tuple(parse_rule(s, f"if e is {s} then u is {s}") for s in sets)
    >>> found = surface(FuzzySystem((error,), (move,), rules))
    >>> [round(float(found(e)[0]), 3) for e in (-1.0, 0.5)]
    [-0.673, 0.124]
    """
    x = ca.SX.sym("x", len(system.inputs))
    values = {variable.name: x[place] for place, variable in enumerate(system.inputs)}
    found = infer(system, values)
    written = [ca.vertcat(*part) for part in zip(*found.values(), strict=True)]
    plain = ca.Function("surface", [x], written)
    columns = []
    for place, variable in enumerate(system.inputs):
        way = ca.SX.zeros(len(system.inputs))
        way[place] = _WAY * (variable.high - variable.low)
        columns.append((plain(x + way)[0] - plain(x - way)[0]) / (2 * way[place]))
    slopes = ca.densify(ca.horzcat(*columns))
    given = [x, *(ca.SX.sym(name, len(system.outputs)) for name in ("values", "fires"))]
    jacobian = ca.Function(
        "jac_surface",
        given,
        [slopes, ca.SX.zeros(slopes.shape)],
        ["x", "out_values", "out_fires"],
        ["jac_values_x", "jac_fires_x"],
    )
    return ca.Function(
        "surface",
        [x],
        written,
        ["x"],
        ["values", "fires"],
        {
            "never_inline": True,
            "custom_jacobian": jacobian,
            "enable_forward": False,
            "enable_reverse": False,
        },
    )
