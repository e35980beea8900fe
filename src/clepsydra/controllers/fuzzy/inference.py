"""Inference: from crisp inputs by degrees, rules and sets to the centroid of each output."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.fuzzy.rule import firing
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable, concluded_sets
from clepsydra.program.block import Block
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.step_law import Equations, Symbols

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


def infer(system: FuzzySystem, values: Mapping[str, ca.SX]) -> dict[str, Centroid]:
    """Return each output's centroid.

    With w(s) the largest firing of the rules that conclude set s, μ(y) = max over s of
    min(w(s), μ_s(y)) and Σ over the points y of the output's range, the centroid is
    Σ y μ(y) / Σ μ(y). The rules of one set are joined first: max min(w, μ_s) = min(max w, μ_s).

    Outputs whose range and concluded sets are the same share one block. In it each stretch of
    points at which the same sets are above zero is a counted loop over those sets alone; the
    others add nothing to the largest, so no bit of the sums changes.

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
    found: dict[str, Centroid] = {}
    blocks: dict[object, Block] = {}
    for output in system.outputs:
        heights = {
            path("height", name): reduce(ca.fmax, [strengths[rule] for rule in rules])
            for name, rules in concluded_sets(system.rules, output.name).items()
        }
        members = {n: each for n, each in output.sets.items() if path("height", n) in heights}
        shape = output.low, output.high, *members.items()
        if shape not in blocks:
            named, taken = Signal(output.name), {block.name for block in blocks.values()}
            short, long = (f"{each}_centroid" for each in (named.part, named.identifier))
            name = long if short in taken else short
            blocks[shape] = _centroid(name, replace(output, sets=members), system.points_of(output))
        results = blocks[shape](path(output.name, "centroid"), heights, {}).outputs
        found[output.name] = Centroid(results["centroid"], results["fires"])
    return found


def _centroid(name: str, output: LinguisticVariable, points: np.ndarray) -> Block:
    """Return the block from the heights of an output's sets to its centroid."""
    degrees = output.degrees(points)

    def equations(heights: Symbols) -> Equations:
        sums, named = ca.SX.zeros(2), dict[str, ca.SX]()
        for first, stop in _stretches(np.array(list(degrees.values())) > 0.0):
            here = {name: d[first:stop] for name, d in degrees.items() if d[first:stop].any()}
            if here:
                sums = _summed(f"from_{first}", points[first:stop], here, heights, sums)
                # A program goes on with the variables of the first stretch.
                named = named or dict(zip(("moment", "area"), ca.vertsplit(sums), strict=True))
        moment, area = ca.vertsplit(sums)
        fires = area > 0
        middle = (output.low + output.high) / 2.0
        value = ca.if_else(fires, moment / ca.if_else(fires, area, 1), middle)
        return Equations({}, {"centroid": value, "fires": fires}, named)

    return Block(
        name,
        tuple(Signal(path("height", n), description=f"how far the output is {n}") for n in degrees),
        (),
        (Signal("centroid", description="crisp output"), truth("fires", "some rule fires")),
        equations,
        ("The centroid of the largest of the sets, each clipped at its height.",),
    )


def _stretches(above: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield first and stop of stretches in which the same sets are above zero [sets, points].

    A single point goes with a neighbour that has its sets among others: they are zero there.
    """
    count = above.shape[1]
    changes = np.flatnonzero((above[:, 1:] != above[:, :-1]).any(axis=0)) + 1
    first = 0
    for start, stop in pairwise([*map(int, changes), count]):
        before, here = above[:, first:start].any(axis=1), above[:, start]
        begins = start - first == 1 and bool((before <= here).all())
        if not (begins or (stop - start == 1 and bool((here <= before).all()))):
            yield first, start
            first = start
    yield first, count


def _summed(
    name: str,
    points: np.ndarray,
    degrees: Mapping[str, np.ndarray],
    heights: Symbols,
    sums: ca.SX,
) -> ca.SX:
    """Return Σ y μ(y) and Σ μ(y) with those of some points added, by a counted loop."""
    row, carried = ca.SX.sym("row", 1 + len(degrees)), ca.SX.sym("sums", 2)
    held = ca.SX.sym("heights", len(degrees))
    point, *here = ca.vertsplit(row)
    largest = reduce(ca.fmax, map(ca.fmin, ca.vertsplit(held), here))
    turn = carried + ca.vertcat(point * largest, largest)
    return counted_loop(
        name,
        len(points),
        ca.Function("point", [row, carried, held], [turn]),
        carried=sums,
        tables=[table.tolist() for table in (points, *degrees.values())],
        invariants=ca.vertcat(*(heights[path("height", name)] for name in degrees)),
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
    found = infer(system, {v.name: x[k] for k, v in enumerate(system.inputs)})
    written = [ca.vertcat(*part) for part in zip(*found.values(), strict=True)]
    plain = ca.Function("surface", [x], written)
    ways = np.diag([_WAY * (variable.high - variable.low) for variable in system.inputs])
    slopes = ca.densify(
        ca.horzcat(*((plain(x + way)[0] - plain(x - way)[0]) / (2 * sum(way)) for way in ways))
    )
    given = [x, *(ca.SX.sym(name, len(system.outputs)) for name in ("values", "fires"))]
    jacobian = ca.Function(
        "jac_surface",
        given,
        [slopes, ca.SX.zeros(slopes.shape)],
        ["x", "out_values", "out_fires"],
        ["jac_values_x", "jac_fires_x"],
    )
    options: dict[str, Any] = {
        "never_inline": True,
        "custom_jacobian": jacobian,
        "enable_forward": False,
        "enable_reverse": False,
    }
    return ca.Function("surface", [x], written, ["x"], ["values", "fires"], options)
