"""The bounds of a tuning as they are written in a study file, and what they are bounds of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.law_parameters import (
    GAINS,
    LawParameters,
    check_law_range,
    in_written_unit,
    key_of,
    new_name,
    parameter_of,
)
from clepsydra.studies.tuning.parameters import ROUNDING, TunedParameter, around
from clepsydra.studies.tuning.weight_space import KINDS


@dataclass(frozen=True, eq=False)
class Bound:
    """The bounds of one parameter, or one weight, as they were written.

    Parameters
    ----------
    table : TableReader
        With a list of two quantities at `key`.
    key : str
        A parameter of the law, a key of a loop, or what a weight is of.
    owner : str
        What it belongs to, if that is written before it: a loop; of a weight its kind, "inputs".
    """

    table: TableReader
    key: str
    owner: str

    @property
    def name(self) -> str:
        """What is bounded, with its owner."""
        return path(self.owner, self.key) if self.owner else self.key

    @property
    def ends(self) -> tuple[TableReader, TableReader]:
        """The table with the low end at the key, and with the high one."""
        written: Any = self.table.raw(self.key)
        low, high = (self.table.with_value(self.key, end) for end in written)
        return low, high

    def refused(self, expected: str, remedy: str) -> InputError:
        """Return the error that says what is wrong with the two."""
        return self.table.wrong(self.key, expected, remedy)

    def read(self, read: Callable[[TableReader], float]) -> tuple[float, float]:
        """Return both ends, in order.

        Raises
        ------
        InputError
            The low one, as it is read, is not below the high one.
        """
        low, high = map(read, self.ends)
        if not low < high:
            raise self.refused("a low bound below the high bound", "exchange or correct them")
        return low, high


def of_weights(bounds: Sequence[Bound]) -> bool:
    """Return whether bounds are those of weights, and not of parameters of the law; not mixed."""
    weighed = [bound for bound in bounds if bound.owner in KINDS]
    others = [bound for bound in bounds if bound.owner not in KINDS]
    if weighed and others:
        raise others[0].table.refused(
            others[0].key,
            f"{others[0].key} beside a weight",
            f"weights alone ({', '.join(KINDS)}), from which the gains follow, or parameters of "
            "the law alone",
            "leave out the one or the other",
        )
    return bool(weighed)


def tuned_weight(bound: Bound, known: Mapping[str, float]) -> TunedParameter:
    """Return a weight between its bounds, one of those that are not zero."""
    key, name = bound.key, bound.name
    if name not in known:
        raise bound.table.refused(
            key,
            name,
            f"a weight that is not zero: {', '.join(known)}",
            suggestion(name, known, "choose one of them"),
        )
    remedy = "give two numbers, as in [1e-3, 1e3]"
    ends = bound.read(lambda end: end.quantity(key, "1", "a weight", remedy, above=0.0))
    return TunedParameter(name, *ends)


def tuned_parameter(
    bound: Bound, controller: Controller, parameters: LawParameters
) -> TunedParameter:
    """Return a parameter of a controller's law between its bounds, in the law's unit."""
    key, name = bound.key, _law_name(bound, parameters)

    def read(end: TableReader) -> float:
        value = parameters.read(end, key, name, "a bound", "give both with their units")
        check_law_range(end, key, parameters.known[name], value)
        return value

    low, high = ends = bound.read(read)
    start = controller.values[name]
    # The gain of a loop is written without its sign, which its action says.
    unsigned = bound.owner in parameters.loops and key in GAINS
    if unsigned and low < 0.0:
        raise bound.refused(
            "bounds that are not negative: the action of the loop gives the gain its sign",
            "leave the signs out",
        )
    if unsigned and start < 0.0:
        low, high = -high, -low
    _check_start(bound, ends, abs(start) if unsigned else start)
    if start == 0.0 or low * high <= 0.0:
        return TunedParameter(name, low, high, logarithmic=False)
    # What follows the parameter, a tracking time the integral time, still does.
    return replace(around(controller, [name])[0], low=low, high=high)


def _law_name(bound: Bound, parameters: LawParameters) -> str:
    """Return the parameter of the law that a bound is for."""
    loop = parameters.loops.get(bound.owner)
    name = bound.name if loop is None else parameter_of(loop, bound.key)
    if name in parameters.known:
        return name
    if loop is None and bound.owner and parameters.loops:
        raise bound.table.refused(
            bound.key, bound.name, f"a loop of this controller ({', '.join(parameters.loops)})",
            suggestion(bound.owner, parameters.loops, "choose one of them"),
        )  # fmt: skip
    known = (
        (*parameters.known, *parameters.loops)
        if loop is None
        else tuple(key_of(parameter) for parameter in loop.parameters())
    )
    now = new_name(bound.key, parameters.known)
    raise bound.table.refused(
        bound.key,
        bound.name if loop is None else bound.key,
        f"a parameter that can be tuned: {', '.join(known)}",
        f"write {now}" if now else suggestion(bound.key, known, "choose one of them"),
    )


def _check_start(bound: Bound, ends: tuple[float, float], start: float) -> None:
    """Refuse bounds that a parameter does not start within."""
    low, high = ends
    slack = ROUNDING * (high - low)
    if not low - slack <= start <= high + slack:
        place = 0 if low else 1  # one that is not zero has a unit to tell
        shown = in_written_unit(bound.ends[place], bound.key, ends[place], start)
        raise bound.refused(
            f"bounds around where it starts, {shown}", "widen the bounds or start elsewhere"
        )
