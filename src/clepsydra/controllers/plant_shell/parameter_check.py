"""Parameters as inputs: each is judged by its bounds, and the last valid value stays in force."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from clepsydra.base.signal import Kind, Signal, path
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import LARGEST_COUNT, LARGEST_NUMBER, all_of
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_INVALID = truth("invalid", "the given value is not valid, and the last valid one is in force")


@cache
def parameter_check(kind: Kind = "real") -> Block:
    """Return the block that judges a parameter.

    Not a number is outside all bounds, since no comparison with it holds.

    Examples
    --------
    A gain of 5 within 0 and 10, and one of 12 after that:

    >>> for value, last in ((5, 3), (12, 5)):
    ...     given = {"value": ca.DM(value), "lowest": ca.DM(0), "highest": ca.DM(10)}
    ...     found = parameter_check()("check", given, {"last_valid": ca.DM(last)})
    ...     print(float(found.outputs["in_force"]), bool(found.outputs["invalid"]))
    5.0 False
    5.0 True
    """

    def equations(s: Symbols) -> Equations:
        value = s["value"]
        valid = ca.logic_and(s["lowest"] <= value, value <= s["highest"])
        in_force = ca.if_else(valid, value, s["last_valid"])
        if kind == "integer":
            in_force = ca.fmin(LARGEST_COUNT, ca.fmax(-LARGEST_COUNT, in_force))
        results = {"in_force": in_force, "invalid": ca.logic_not(valid)}
        return Equations({"last_valid": in_force}, results)

    most = LARGEST_COUNT if kind == "integer" else math.inf

    def port(name: str, description: str) -> Signal:
        return Signal(name, low=-most, high=most, kind=kind, description=description)

    return Block(
        "parameter_check" if kind == "real" else "count_check",
        (
            port("value", "as it is given"),
            port("lowest", "lowest value that is valid"),
            port("highest", "highest value that is valid"),
        ),
        (port("last_valid", "the last valid value"),),
        (port("in_force", "the value, if it is valid, or the last valid one"), _INVALID),
        equations,
        ("A parameter within its bounds; else the last valid value stays in force.",),
    )


@cache
def ends_check(*, ordered: bool) -> Block:
    """Return the block that judges two ends: limits of an output, or a range.

    `ordered`: whether the low end has to be below the high one; else they have to differ.
    """

    def equations(s: Symbols) -> Equations:
        low, high = s["low"], s["high"]
        apart = low < high if ordered else low != high
        bounds = [s["lowest"] <= end for end in (low, high)]
        bounds += [end <= s["highest"] for end in (low, high)]
        valid = all_of([apart, *bounds])
        ends = {
            name: ca.if_else(valid, s[name], s[f"last_valid_{name}"]) for name in ("low", "high")
        }
        state = {f"last_valid_{name}": end for name, end in ends.items()}
        results = {f"{name}_in_force": end for name, end in ends.items()}
        return Equations(state, results | {"invalid": ca.logic_not(valid)})

    return Block(
        "limits_check" if ordered else "range_check",
        (
            Signal("low", description="low end as it is given"),
            Signal("high", description="high end as it is given"),
            Signal("lowest", description="lowest value that is valid"),
            Signal("highest", description="highest value that is valid"),
        ),
        (
            Signal("last_valid_low", description="low end when both were valid the last time"),
            Signal("last_valid_high", description="high end when both were valid the last time"),
        ),
        (
            Signal("low_in_force", description="the low end, or the last valid one"),
            Signal("high_in_force", description="the high end, or the last valid one"),
            _INVALID,
        ),
        equations,
        (
            "Two ends, the low one below the high one" if ordered else "Two ends that differ",
            "and both within their bounds; else the last valid ones stay in force.",
        ),
    )


@dataclass(frozen=True)
class Judged:
    """A parameter, or two ends, with the block that judges it.

    `parameters`: by the port that takes each; `bounds`: lowest and highest.
    """

    block: Block
    parameters: dict[str, Signal]
    bounds: tuple[float, float]

    @property
    def instance(self) -> str:
        """What it is called in the shell."""
        first, *others = self.parameters.values()
        return path(first.owner, self.block.name) if others else path(first, "check")

    @property
    def names(self) -> set[str]:
        """The names of what is judged."""
        return {parameter.name for parameter in self.parameters.values()}

    @property
    def state(self) -> dict[str, Signal]:
        """State of the block to the parameter that it is the last valid value of."""
        return dict(zip((s.name for s in self.block.state), self.parameters.values(), strict=True))

    @property
    def results(self) -> dict[str, Signal]:
        """Output of the block to the parameter that it is in the place of."""
        outputs = (s.name for s in self.block.outputs[:-1])
        return dict(zip(outputs, self.parameters.values(), strict=True))


def judged(parameters: Iterable[Signal], ranges: Iterable[tuple[str, str]]) -> Iterator[Judged]:
    """Yield what judges the parameters of a shell.

    Where one has to be below another, or two are the ends of a range, both are judged together. A
    truth value is always valid, and so is a whole number without bounds.

    `ranges`: low and high end by name.
    """
    known = {parameter.name: parameter for parameter in parameters}
    pairs = [(p.name, path(p.owner, p.below), True) for p in known.values() if p.below]
    pairs += [(*ends, False) for ends in ranges]
    paired = {name: (low, high, ordered) for low, high, ordered in pairs for name in (low, high)}
    for name, parameter in known.items():
        if name in paired:
            low, high, ordered = paired[name]
            if name == low:
                bounds = _bounds(known[low])[0], _bounds(known[high])[1]
                yield Judged(
                    ends_check(ordered=ordered), {"low": known[low], "high": known[high]}, bounds
                )
        elif parameter.kind == "real" or (
            parameter.kind == "integer" and max(map(abs, _bounds(parameter))) <= LARGEST_COUNT
        ):
            block = parameter_check(parameter.kind)
            yield Judged(block, {"value": parameter}, _bounds(parameter))


def last_valid(parameter: Signal) -> Signal:
    """Return the state that keeps the last valid value of a parameter."""
    own = f"valid_{parameter.part}"
    name = path(parameter.owner, own) if parameter.owner else own
    return replace(parameter, name=name, description=f"{parameter.description}: last valid value")


def _bounds(parameter: Signal) -> tuple[float, float]:
    return max(parameter.low, -LARGEST_NUMBER), min(parameter.high, LARGEST_NUMBER)
