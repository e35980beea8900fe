"""Inference: from crisp inputs by degrees, rules and sets to the centroid of each output."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import truth, words_for
from clepsydra.controllers.blocks.validity import limit
from clepsydra.controllers.fuzzy.rule import firing
from clepsydra.controllers.fuzzy.system import FuzzySystem, LinguisticVariable
from clepsydra.program.block import Block
from clepsydra.program.counted_loop import Table, counted_loop
from clepsydra.program.step_law import Equations, Symbols

#: Way of a difference quotient, as a share of an input's range; the cube root of rounding.
_WAY = 1e-5
#: What the rules tell of an output.
CRISP = (
    Signal("centroid", description="crisp output of the rules"),
    truth("fires", "some rule fires"),
)


def _inferred(
    system: FuzzySystem, values: Mapping[str, ca.SX]
) -> tuple[dict[str, Symbols], dict[str, ca.SX]]:
    """Return centroid and fires of each output, and by name how far each set and rule holds."""
    between, degrees = dict[str, ca.SX](), dict[tuple[str, str], ca.SX]()
    for variable in system.inputs:
        clipped = limit(values[variable.name], ca.SX(variable.low), ca.SX(variable.high))
        between[path(variable.name, "clipped")] = clipped
        for name, member in variable.sets.items():
            degrees[variable.name, name] = member.expression(clipped)
    strengths = {rule: firing(rule.condition, degrees, ca.fmin, ca.fmax) for rule in system.rules}
    found: dict[str, Symbols] = {}
    blocks: dict[object, Block] = {}
    for output in system.outputs:
        heights = {
            path("height", name): reduce(ca.fmax, [strengths[rule] for rule in rules])
            for name, rules in system.concluded(output.name).items()
        }
        members = {n: each for n, each in output.sets.items() if path("height", n) in heights}
        shape = output.low, output.high, *members.items()
        if shape not in blocks:
            named, taken = Signal(output.name), {block.name for block in blocks.values()}
            short, long = (f"{each}_centroid" for each in (named.part, named.identifier))
            name = long if short in taken else short
            blocks[shape] = _centroid(name, replace(output, sets=members), system.points_of(output))
        found[output.name] = blocks[shape](output.name, heights, {}).outputs
    between |= {path(*each): degree for each, degree in degrees.items()}
    # The name of a rule is free text: one that is no name is not printed.
    printed = (rule for rule in system.rules if re.fullmatch(r"[A-Za-z]\w*", rule.name, re.ASCII))
    return found, between | {rule.name: strengths[rule] for rule in printed}


def _centroid(name: str, output: LinguisticVariable, points: np.ndarray) -> Block:
    """Return the block from the heights of an output's sets to its centroid."""
    degrees = output.degrees(points)
    stretches = [*_stretches(np.array(list(degrees.values())) > 0.0)]
    tables = [Table("point", tuple(points.tolist()), 0, "points of the range of the output")]
    for each, degree in degrees.items():
        varying = [place for place in stretches if np.ptp(degree[slice(*place)]) > 0.0]
        if varying:
            first, stop = varying[0][0], varying[-1][1]
            words = f"how far the points from {first} on are {each}"
            values = tuple(degree[first:stop].tolist())
            lines = output.sets[each].edges
            tables.append(Table(path("degree", each), values, first, words, "point", lines))

    def equations(heights: Symbols) -> Equations:
        sums, named = ca.SX.zeros(2), dict[str, ca.SX]()
        for first, stop in stretches:
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
        tuple(
            Signal(path("height", n), description="how far the output is in that set")
            for n in degrees
        ),
        (),
        CRISP,
        equations,
        ("The centroid of the largest of the sets, each clipped at its height.",),
        tables=tuple(tables),
    )


def _stretches(above: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield first and stop of stretches in which the same sets are above zero [sets, points]."""
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
    tables = {"point": points}
    tables |= {name: table for name, table in degrees.items() if table.min() < table.max()}
    row, carried = ca.SX.sym("row", len(tables)), ca.SX.sym("sums", 2)
    held = ca.SX.sym("heights", len(degrees))
    here = dict(zip(tables, ca.vertsplit(row), strict=True))
    clipped = [
        ca.fmin(height, here.get(name, degrees[name][0]))
        for name, height in zip(degrees, ca.vertsplit(held), strict=True)
    ]
    largest = reduce(ca.fmax, clipped)
    turn = carried + ca.vertcat(here["point"] * largest, largest)
    return counted_loop(
        name,
        len(points),
        ca.Function("point", [row, carried, held], [turn]),
        carried=sums,
        tables=[table.tolist() for table in tables.values()],
        invariants=ca.vertcat(*(heights[path("height", name)] for name in degrees)),
    )


def surface(system: FuzzySystem) -> ca.Function:
    """Return the centroids as a function of the crisp inputs.

    Its derivatives are central differences over a hundred-thousandth of each range: where the
    inputs are zero, the sets of most controllers meet in corners, at which the derivative of the
    equations as they stand has no meaning. The slope there is the mean of those on both sides.

    Returns
    -------
    casadi.Function
        (inputs [m]) → (centroids [q], whether any rule fires [q]), in the order of the system.
    """
    x = ca.SX.sym("x", len(system.inputs))
    values, fires, _ = _function(system)[0](x)
    return ca.Function("surface", [x], [values, fires], ["x"], ["values", "fires"])


def _function(system: FuzzySystem) -> tuple[ca.Function, list[str]]:
    """Return the surface with a third result, values on the way, and their names."""
    x = ca.SX.sym("x", len(system.inputs))
    found, between = _inferred(system, {v.name: x[k] for k, v in enumerate(system.inputs)})
    values, fires = (ca.vertcat(*(u[port.name] for u in found.values())) for port in CRISP)
    results = {"values": values, "fires": fires, "between": ca.vertcat(*between.values())}
    plain = ca.Function("surface", [x], [values])
    ways = np.diag([_WAY * (variable.high - variable.low) for variable in system.inputs])
    slopes = [(plain(x + way) - plain(x - way)) / (2 * sum(way)) for way in ways]
    rest = [ca.SX.zeros(results[name].numel(), x.numel()) for name in ("fires", "between")]
    jacobian = ca.Function(
        "jac_surface",
        [x, *(ca.SX.sym(name, each.numel()) for name, each in results.items())],
        [ca.densify(ca.horzcat(*slopes)), *rest],
        ["x", *(f"out_{name}" for name in results)],
        [f"jac_{name}_x" for name in results],
    )
    options: dict[str, Any] = {
        "never_inline": True,
        "custom_jacobian": jacobian,
        "enable_forward": False,
        "enable_reverse": False,
    }
    names = [*results]
    return ca.Function("surface", [x], [*results.values()], ["x"], names, options), [*between]


def rule_base(system: FuzzySystem, name: str) -> Block:
    """Return the block from the inputs of a system to centroid and fires of each output.

    With w(s) the largest firing of the rules that conclude set s, μ(y) = max over s of
    min(w(s), μ_s(y)) and Σ over the points y of the output's range, the centroid is
    Σ y μ(y) / Σ μ(y), or the middle of the range where no rule fires. The rules of one set are
    joined first: max min(w, μ_s) = min(max w, μ_s).

    Outputs whose range and concluded sets are the same share one block. In it each stretch of
    points at which the same sets are above zero is a counted loop over those sets alone; the
    others add nothing to the largest, so no bit of the sums changes. The derivatives are those of
    `surface`.

    `name`: of the block.

    References
    ----------
    E. H. Mamdani, Application of fuzzy algorithms for control of simple dynamic plant,
    Proceedings of the IEE 121(12), 1974, 1585-1588, doi 10.1049/piee.1974.0328.
    """
    centroids = [Signal(path(u.name, "centroid"), description="crisp") for u in system.outputs]
    fires = [truth(path(u.name, "fires"), "some rule fires for it") for u in system.outputs]
    ports = (*centroids, *fires)

    def equations(s: Symbols) -> Equations:
        function, names = _function(system)
        values, fires, between = function(ca.vertcat(*(s[v.name] for v in system.inputs)))
        results = ca.vertsplit(ca.vertcat(values, fires))
        named = dict(zip(names, ca.vertsplit(between), strict=True))
        words = words_for({rule.name: str(rule) for rule in system.rules}, named)
        return Equations({}, dict(zip((p.name for p in ports), results, strict=True)), named, words)

    inputs = tuple(Signal(v.name, description="times its gain") for v in system.inputs)
    words = "How far inputs are in sets and rules hold, and the centroid of each output."
    return Block(name, inputs, (), ports, equations, (words,))
