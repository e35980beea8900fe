"""Inference: from crisp inputs by degrees, rules and sets to the centroid of each output."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
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
    """Return centroid and fires of each output, and by name what is computed on the way."""
    between, degrees = dict[str, ca.SX](), dict[tuple[str, str], ca.SX]()
    for variable in system.inputs:
        clipped = limit(values[variable.name], ca.SX(variable.low), ca.SX(variable.high))
        between[path(variable.name, "clipped")] = clipped
        for name, member in variable.sets.items():
            degrees[variable.name, name] = member.expression(clipped)
    between |= {path(*each): degree for each, degree in degrees.items()}
    strengths = {rule: firing(rule.condition, degrees, ca.fmin, ca.fmax) for rule in system.joined}
    # The name of a rule is free text: one that is no name is not printed.
    printed = (rule for rule in strengths if re.fullmatch(r"[A-Za-z]\w*", rule.name, re.ASCII))
    between |= {rule.name: strengths[rule] for rule in printed}
    found: dict[str, Symbols] = {}
    for each in _centroids(system):
        output = each.output.name
        heights = {
            path("height", name): reduce(ca.fmax, [strengths[rule] for rule in rules])
            for name, rules in system.concluded(output).items()
        }
        if each.block:
            found[output] = each.block(output, heights, {}).outputs
        else:
            told = each.equations(heights)
            found[output] = told.outputs
            between |= {path(output, name): value for name, value in told.intermediates.items()}
    return found, between


@dataclass
class _Centroid:
    """From the heights of an output's sets to its centroid."""

    output: LinguisticVariable
    points: np.ndarray
    #: What the points of its range are called, which other outputs may have too.
    place: str
    #: What several outputs have in common is a block.
    block: Block | None = None

    def __post_init__(self) -> None:
        self.degrees = self.output.degrees(self.points)
        self.stretches = [*_stretches(np.array(list(self.degrees.values())) > 0.0)]

    def tables(self, degree_of: str, place: str) -> Iterator[Table]:
        """Yield what the loops over the stretches read: degrees of sets, and points by a name."""
        yield Table(place, tuple(self.points.tolist()), 0, "points of the range of the output")
        for each, degree in self.degrees.items():
            varying = [some for some in self.stretches if np.ptp(degree[slice(*some)]) > 0.0]
            if varying:
                first, stop = varying[0][0], varying[-1][1]
                words = f"how far the points from {first} on are {each}"
                values = tuple(degree[first:stop].tolist())
                lines = self.output.sets[each].edges
                yield Table(path(degree_of, each), values, first, words, place, lines)

    def equations(self, heights: Symbols) -> Equations:
        """Return centroid and fires from the heights."""
        sums, named = ca.SX.zeros(2), dict[str, ca.SX]()
        for first, stop in self.stretches:
            here = {n: d[first:stop] for n, d in self.degrees.items() if d[first:stop].any()}
            if here:
                sums = _summed(f"from_{first}", self.points[first:stop], here, heights, sums)
                # A program goes on with the variables of the first stretch.
                named = named or dict(zip(("moment", "area"), ca.vertsplit(sums), strict=True))
        moment, area = ca.vertsplit(sums)
        fires = area > 0
        middle = (self.output.low + self.output.high) / 2.0
        value = ca.if_else(fires, moment / ca.if_else(fires, area, 1), middle)
        return Equations({}, {"centroid": value, "fires": fires}, named)

    def as_block(self, name: str) -> Block:
        """Return it as a block."""
        words = "how far the output is in that set"
        heights = (Signal(path("height", n), description=words) for n in self.degrees)
        return Block(
            name,
            tuple(heights),
            (),
            CRISP,
            self.equations,
            ("The centroid of the largest of the sets, each clipped at its height.",),
            tables=tuple(self.tables("degree", "point")),
        )


def _centroids(system: FuzzySystem) -> list[_Centroid]:
    """Return the centroid of each output."""
    found, ranges = list[_Centroid](), dict[tuple[float, float], str]()
    for output in system.outputs:
        concluded = system.concluded(output.name)
        sets = {name: each for name, each in output.sets.items() if name in concluded}
        place = ranges.setdefault((output.low, output.high), path(output.name, "point"))
        found.append(_Centroid(replace(output, sets=sets), system.points_of(output), place))
    shapes = [(each.output.low, each.output.high, *each.output.sets.items()) for each in found]
    blocks: dict[object, Block] = {}
    for each, shape in zip(found, shapes, strict=True):
        if shapes.count(shape) > 1:
            if shape not in blocks:
                named, taken = Signal(each.output.name), {block.name for block in blocks.values()}
                short, long = (f"{name}_centroid" for name in (named.part, named.identifier))
                blocks[shape] = each.as_block(long if short in taken else short)
            each.block = blocks[shape]
    return found


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
    _, values, fires = _function(system)[0](x)
    return ca.Function("surface", [x], [values, fires], ["x"], ["values", "fires"])


def _function(system: FuzzySystem) -> tuple[ca.Function, list[str]]:
    """Return the surface behind a further result, values on the way, and their names.

    They come first, so that a program has them one below the other, and the loops below them.
    """
    x = ca.SX.sym("x", len(system.inputs))
    found, between = _inferred(system, {v.name: x[k] for k, v in enumerate(system.inputs)})
    values, fires = (ca.vertcat(*(u[port.name] for u in found.values())) for port in CRISP)
    results = {"between": ca.vertcat(*between.values()), "values": values, "fires": fires}
    plain = ca.Function("surface", [x], [values])
    ways = np.diag([_WAY * (variable.high - variable.low) for variable in system.inputs])
    slopes = [(plain(x + way) - plain(x - way)) / (2 * sum(way)) for way in ways]
    of_between, of_fires = (
        ca.SX.zeros(results[name].numel(), x.numel()) for name in ("between", "fires")
    )
    jacobian = ca.Function(
        "jac_surface",
        [x, *(ca.SX.sym(name, each.numel()) for name, each in results.items())],
        [of_between, ca.densify(ca.horzcat(*slopes)), of_fires],
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
    joined first: max min(w, μ_s) = min(max w, μ_s), and so are the conditions of those rules that
    conclude the same: max(min(a, b), min(a, c)) = min(a, max(b, c)), in every bit.

    Each stretch of points at which the same sets are above zero is a counted loop over those sets
    alone; the others add nothing to the largest, so no bit of the sums changes. Outputs whose
    range and concluded sets are the same share one block with these loops. The derivatives are
    those of `surface`.

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
        between, values, fires = function(ca.vertcat(*(s[v.name] for v in system.inputs)))
        results = ca.vertsplit(ca.vertcat(values, fires))
        named = dict(zip(names, ca.vertsplit(between), strict=True))
        words = words_for({rule.name: str(rule) for rule in system.joined}, named)
        return Equations({}, dict(zip((p.name for p in ports), results, strict=True)), named, words)

    inputs = tuple(Signal(v.name, description="times its gain") for v in system.inputs)
    owned = [each for each in _centroids(system) if not each.block]
    tables = [
        table
        for each in owned
        for table in each.tables(path(each.output.name, "degree"), each.place)
    ]
    words = "How far inputs are in sets and rules hold, and the centroid of each output."
    return Block(name, inputs, (), ports, equations, (words,), tables=tuple(tables))
