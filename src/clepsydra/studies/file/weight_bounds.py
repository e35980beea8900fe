"""The weights that a study file wants tuned, each with its bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.studies.file.placed import placed
from clepsydra.studies.file.tuning_bound import Bound
from clepsydra.studies.tuning.lqi_weights import KINDS, LqiWeights, WeightedDesign
from clepsydra.studies.tuning.parameters import TunedParameter

#: Takes the controller that was designed, and the model with all measurements.
WeightedStart = Callable[[Controller, LinearModel], WeightedDesign]


def of_weights(bounds: Sequence[Bound]) -> bool:
    """Return whether bounds are those of weights, and not of parameters of the law.

    Raises
    ------
    InputError
        Some are, and others are not.

    Examples
    --------
    >>> of_weights([])
    False
    """
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


def weight_parameters(
    start: WeightedDesign, bounds: Sequence[Bound] | None
) -> tuple[TunedParameter, ...] | None:
    """Return the weights that are tuned, as `tuned_lqi` takes them; None where none are named.

    Raises
    ------
    InputError
        A weight is unknown or zero, or its bounds are no two numbers in order.

    Examples
    --------
    >>> weight_parameters(None, None)
    """
    if bounds is None:
        return None
    known = LqiWeights(start).numbers
    return tuple(_weight(bound, known) for bound in bounds)


def places_of(bounds: Sequence[Bound] | None) -> dict[str, str]:
    """Return where the bounds of each weight stand.

    Examples
    --------
    >>> places_of(None)
    {}
    """
    return {f"{bound.owner}.{bound.key}": bound.table.place(bound.key) for bound in bounds or ()}


def _weight(bound: Bound, known: dict[str, float]) -> TunedParameter:
    table, key, name = bound.table, bound.key, f"{bound.owner}.{bound.key}"
    if name not in known:
        raise table.refused(
            key,
            name,
            f"a weight that is not zero: {', '.join(known)}",
            suggestion(name, known, "choose one of them"),
        )
    written: Any = table.raw(key)
    low, high = (
        table.with_value(key, end).quantity(
            key, "1", "a weight", "give two numbers, as in [1e-3, 1e3]", above=0.0
        )
        for end in written
    )
    bound.check_order(low, high)
    with placed(table, {name: table.place(key)}):
        return TunedParameter(name, low, high)
