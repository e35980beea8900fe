"""A Mamdani system: linguistic variables and rules, checked as a whole."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.fuzzy.membership import Membership
from clepsydra.controllers.fuzzy.rule import Rule, atoms, firing, joined

#: Numbers of points on which a centroid may be taken.
FEWEST_POINTS, MOST_POINTS = 3, 1001
#: Combinations of sets that are tried in the search for a gap in the rules.
_MOST_COMBINATIONS = 5_000_000


@dataclass(frozen=True)
class LinguisticVariable:
    """A quantity with its range and the sets that stand for its values in words.

    `low`, `high`: the range; an input is clipped to it, an output's centroid is taken over it;
    `sets`: name to membership function.

    Raises InputError: the range is empty, there is no set, or a set is zero in the whole range.

    Examples
    --------
    >>> from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
    >>> error = LinguisticVariable(
    ...     "e", -1.0, 1.0, {"N": left_shoulder(-1.0, 1.0), "P": right_shoulder(-1.0, 1.0)})
    >>> error.degrees([0.5])["P"].tolist()
    [0.75]
    """

    name: str
    low: float
    high: float
    sets: Mapping[str, Membership]

    def __post_init__(self) -> None:
        if not (self.low < self.high and math.isfinite(self.high - self.low)):
            raise InputError(
                f"{self.name}.range", f"{self.low:g}, {self.high:g}",
                "a lower end below the upper end", "correct the range",
            )  # fmt: skip
        if not self.sets:
            raise InputError(f"{self.name}.sets", Finding("no set"), "at least one set", "add one")
        for name, degrees in self.degrees(self.samples).items():
            if not degrees.any():
                raise InputError(
                    f"{self.name}.sets.{name}", "a set outside of the range",
                    f"a set above zero somewhere from {self.low:g} to {self.high:g}",
                    "correct its points, or widen the range",
                )  # fmt: skip

    def degrees(self, x: object) -> dict[str, np.ndarray]:
        """Return the degrees of membership of numbers [n] in each set."""
        return {name: member.degrees(x) for name, member in self.sets.items()}

    @cached_property
    def samples(self) -> np.ndarray:
        """Places among which every combination of sets that are above zero occurs."""
        corners = {corner for member in self.sets.values() for corner in member.corners}
        inside = {corner for corner in corners if self.low < corner < self.high}
        places = np.array(sorted({self.low, self.high} | inside))
        return np.sort(np.concatenate([places, (places[:-1] + places[1:]) / 2.0]))

    def patterns(self) -> np.ndarray:
        """Return a sample for each different combination of sets that are above zero [k]."""
        above = np.array([degrees > 0.0 for degrees in self.degrees(self.samples).values()])
        _, first = np.unique(above, axis=1, return_index=True)
        return self.samples[np.sort(first)]


@dataclass(frozen=True, eq=False)
class FuzzySystem:
    """Inputs, outputs and rules of a Mamdani system; two are equal where they are the same object.

    `points`: on how many points of an output's range its centroid is taken.

    Raises InputError: A name stands twice, a rule names what there is not, the number of points is
    unfit, a set of an output lies between its points, or there are inputs with which no rule fires
    for some output.

    Examples
    --------
    >>> from clepsydra.controllers.fuzzy.membership import left_shoulder, right_shoulder
    >>> from clepsydra.controllers.fuzzy.rule import parse_rule
    >>> halves = {"N": left_shoulder(-1.0, 1.0), "P": right_shoulder(-1.0, 1.0)}
    >>> error, move = (LinguisticVariable(name, -1.0, 1.0, halves) for name in ("e", "u"))
    >>> system = FuzzySystem((error,), (move,), (parse_rule("R1", "if e is N then u is N"),))
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: outputs.u: got no rule that fires at e = 1, expected a \
rule that fires wherever the inputs are; add a rule or widen a set, since the output would be \
held there.
    """

    inputs: tuple[LinguisticVariable, ...]
    outputs: tuple[LinguisticVariable, ...]
    rules: tuple[Rule, ...]
    points: int = 101

    def __post_init__(self) -> None:
        if not FEWEST_POINTS <= self.points <= MOST_POINTS:
            raise InputError(
                "points", self.points,
                f"a whole number from {FEWEST_POINTS} to {MOST_POINTS}", "101 is usual",
            )  # fmt: skip
        names = [variable.name for variable in (*self.inputs, *self.outputs)]
        for place, name in enumerate(names):
            if names.count(name) > 1:
                kind = "inputs" if place < len(self.inputs) else "outputs"
                raise InputError(f"{kind}.{name}", name, "a name of its own", "rename one")
        for rule in self.rules:
            self._check_names(rule)
        for output in self.outputs:
            self._check_points(output)
            self._check_gaps(output)

    def used_by(self, output: str) -> tuple[LinguisticVariable, ...]:
        """Return the inputs that the rules for an output read."""
        read = {a.variable for rule in self.rules_for(output) for a in atoms(rule.condition)}
        return tuple(variable for variable in self.inputs if variable.name in read)

    def rules_for(self, output: str) -> list[Rule]:
        """Return the rules that conclude something about an output."""
        return [r for r in self.rules if any(each.variable == output for each in r.conclusions)]

    @property
    def joined(self) -> tuple[Rule, ...]:
        """The rules, of which those that conclude the same are one."""
        return joined(self.rules)

    def concluded(self, output: str) -> dict[str, list[Rule]]:
        """Return the sets that joined rules conclude about an output, each with its rules."""
        found: dict[str, list[Rule]] = {}
        for rule in self.joined:
            for each in rule.conclusions:
                if each.variable == output:
                    found.setdefault(each.set, []).append(rule)
        return found

    def points_of(self, output: LinguisticVariable) -> np.ndarray:
        """Return the points of an output's range [points]."""
        return np.linspace(output.low, output.high, self.points)

    def _check_names(self, rule: Rule) -> None:
        for what, variables, named in (
            ("an input", self.inputs, atoms(rule.condition)),
            ("an output", self.outputs, rule.conclusions),
        ):
            known = {variable.name: variable.sets for variable in variables}
            for each in named:
                _check_known(rule, each.variable, known, what)
                _check_known(rule, each.set, known[each.variable], f"a set of {each.variable}")

    def _check_points(self, output: LinguisticVariable) -> None:
        concluded = self.concluded(output.name)
        for name, degrees in output.degrees(self.points_of(output)).items():
            if name in concluded and not degrees.any():
                raise InputError(
                    f"outputs.{output.name}.sets.{name}", "a set between two points",
                    f"a set above zero at one of the {self.points} points from {output.low:g} to "
                    f"{output.high:g}", "widen it, or take more points",
                )  # fmt: skip

    def _check_gaps(self, output: LinguisticVariable) -> None:
        """Refuse rules of which none fires somewhere: the output would have no centroid there."""
        rules = self.rules_for(output.name)
        if not rules:
            raise InputError(
                f"outputs.{output.name}",
                Finding("no rule about it"),
                "at least one",
                "add rules for it",
            )
        used = self.used_by(output.name)
        axes = [variable.patterns() for variable in used]
        combinations = math.prod(len(axis) for axis in axes)
        if combinations > _MOST_COMBINATIONS:
            raise InputError(
                f"outputs.{output.name}", f"rules that read {len(used)} inputs",
                f"at most {_MOST_COMBINATIONS:,} combinations of their sets, not {combinations:,}",
                "let the rules for an output read fewer inputs",
            )  # fmt: skip
        grid = np.meshgrid(*axes, indexing="ij", sparse=True)
        degrees = {
            (variable.name, name): found > 0.0
            for variable, places in zip(used, grid, strict=True)
            for name, found in variable.degrees(places).items()
        }
        held = (firing(r.condition, degrees, np.logical_and, np.logical_or) for r in rules)
        gaps = np.argwhere(~reduce(np.logical_or, held))
        if not len(gaps):
            return
        where = {v.name: float(axis[at]) for v, axis, at in zip(used, axes, gaps[0], strict=True)}
        shown = ", ".join(f"{name} = {value:g}" for name, value in where.items())
        without = [v for v in used if not any(d.any() for d in v.degrees([where[v.name]]).values())]
        place = f"inputs.{without[0].name}.sets" if without else f"outputs.{output.name}"
        raise InputError(
            place,
            Finding(
                f"no rule that fires at {shown}"
                + (f" for {output.name}, since no set is above zero there" if without else "")
            ),
            "a rule that fires wherever the inputs are",
            "add a rule or widen a set, since the output would be held there",
        )


def _check_known(rule: Rule, name: str, known: Mapping[str, object], what: str) -> None:
    if name not in known:
        expected, remedy = f"{what} ({', '.join(known)})", "correct the rule"
        raise InputError(f"rules.{rule.name}", name[:60], expected, suggestion(name, known, remedy))
