"""Fuzzy systems for tests, and their inference by other routes."""

import itertools
from pathlib import Path

import numpy as np

import clepsydra
from clepsydra.controllers.fuzzy.file import load_fuzzy
from clepsydra.controllers.fuzzy.membership import Trapezoid

#: Four inputs, three outputs and 27 rules of a document; its file comes with the package.
(RULES,) = Path(clepsydra.__file__).parent.rglob("averaging-tank-fuzzy.toml")
DOCUMENT = load_fuzzy(RULES).system


def plain_heights(system, values):
    """How far the rules conclude each set, one rule after the other, in Python numbers."""

    def degree(condition):
        parts = getattr(condition, "parts", None)
        if parts is None:
            variable = next(v for v in system.inputs if v.name == condition.variable)
            x = min(max(values[variable.name], variable.low), variable.high)
            return float(variable.sets[condition.set].degrees(x))
        found = [degree(part) for part in parts]
        return min(found) if type(condition).__name__ == "All" else max(found)

    heights = {output.name: {} for output in system.outputs}
    for rule in system.rules:
        fired = degree(rule.condition)
        for each in rule.conclusions:
            known = heights[each.variable]
            known[each.set] = max(known.get(each.set, 0.0), fired)
    return heights


def degrees(member, points):
    """Of sets with straight edges by NumPy alone: another route, and a quick one."""
    if not isinstance(member, Trapezoid):
        return member.degrees(points)
    s = member
    rising = (points - s.foot) / (s.top - s.foot) if s.foot < s.top else np.ones_like(points)
    falling = (s.end - points) / (s.end - s.end_of_top) if s.end_of_top < s.end else 1.0
    inside = (s.foot <= points) & (points <= s.end)
    return np.where(inside, np.clip(np.minimum(rising, falling), 0.0, 1.0), 0.0)


def aggregated(output, heights, points):
    """The largest of the clipped sets at some points."""
    clipped = [np.minimum(h, degrees(output.sets[name], points)) for name, h in heights.items()]
    return np.max(clipped, axis=0)


def summed_centroid(output, heights, points):
    """Sums over points that are given, all sets at all points."""
    shape = aggregated(output, heights, points)
    return float(np.sum(points * shape) / np.sum(shape))


def exact_centroid(output, heights):
    """The centroid of the area itself, piece by piece: only for sets with straight edges.

    Between neighbours of all places where an edge or a height meets another one, the largest of
    the clipped sets is a straight line.
    """
    lines = [(0.0, 0.0)] + [(0.0, h) for h in heights.values()]
    places = {output.low, output.high}
    for name in heights:
        s = output.sets[name]
        places.update(s.corners)
        if s.foot < s.top:
            lines.append((1 / (s.top - s.foot), -s.foot / (s.top - s.foot)))
        if s.end_of_top < s.end:
            lines.append((-1 / (s.end - s.end_of_top), s.end / (s.end - s.end_of_top)))
    for (a, b), (c, d) in itertools.combinations(lines, 2):
        if a != c:
            places.add((d - b) / (a - c))
    cuts = np.array(sorted(p for p in places if output.low <= p <= output.high))
    cuts = cuts[np.concatenate([[True], np.diff(cuts) > 1e-13])]
    inner = 0.25 * np.diff(cuts)
    left, right = cuts[:-1] + inner, cuts[1:] - inner  # inside, so that upright edges do no harm
    y, z = aggregated(output, heights, left), aggregated(output, heights, right)
    slope = (z - y) / (right - left)
    start, end = y - slope * inner, z + slope * inner
    width = np.diff(cuts)
    area = width * (start + end) / 2
    moment = width * (cuts[:-1] * (2 * start + end) + cuts[1:] * (start + 2 * end)) / 6
    return float(moment.sum() / area.sum())
