"""The numbers of a law at an operating point: what a design found, and what is read off there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.designs.designed_values import designed_values, kind
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.step_law import StepLaw

#: What is the value of its owner at the operating point.
_AT_REST = ("reference", "bias", "last_output", "filtered")


def numbers_at(
    point: OperatingPoint, entries: Iterable[Entry], **found: ArrayLike
) -> dict[str, float]:
    """Return the values of parameters or states of a law.

    References, biases and last outputs are those of the operating point, limits those of the
    process; what is neither there nor found has its initial value.

    Parameters
    ----------
    **found : array_like
        By the matrix or part that they are (`designed_values.kind`), in the order of the entries;
        one number is that of all of them. What the law does not have is passed over.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.base.signal import Signal
    >>> point = cl.load("quadruple-tank").linear.point
    >>> names = [f"pump_{k}.{part}" for k in (1, 2) for part in ("bias", "high_limit", "time")]
    >>> list(numbers_at(point, map(Signal, names), time=[30.0, 20.0]).values())
    [3.0, 10.0, 30.0, 3.0, 10.0, 20.0]
    """
    at, signal = point.as_dict(), point.process.signal
    arrays = {what: np.asarray(numbers, float) for what, numbers in found.items()}
    numbers = {
        what: iter(array.ravel().tolist()) if array.ndim else repeat(array.item())
        for what, array in arrays.items()
    }
    values = {}
    for entry in map(signal_of, entries):
        if (what := kind(entry)) in numbers:
            values[entry.name] = next(numbers[what])
        elif entry.part in _AT_REST and entry.owner in at:
            values[entry.name] = at[entry.owner]
        elif entry.part == "low_limit":
            values[entry.name] = signal(entry.owner).low
        elif entry.part == "high_limit":
            values[entry.name] = signal(entry.owner).high
        else:
            values[entry.name] = entry.initial
    return values


def controller_at(
    point: OperatingPoint,
    name: str,
    family: str,
    law: StepLaw,
    values: Mapping[str, float],
    state: Mapping[str, float] | None = None,
    *,
    design: str = "",
    **more: Any,
) -> Controller:
    """Return a controller at rest, whose law calls its signals as the process does.

    Parameters
    ----------
    name, family, law, design
        As in `Controller`.
    values : mapping
        Of all parameters, as they were computed: they are rounded.
    state : mapping, optional
        The initial one; left out where the law finds its rest by tracking the point.
    **more
        Notes and what else a `Controller` has.

    Raises
    ------
    NotApplicable
        A number is outside of what a controller takes.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> point = cl.load("quadruple-tank").point
    >>> law = multiloop_pid_law(["level_1"], ["pump_2"])
    >>> found = controller_at(point, "PI", "PI", law, numbers_at(point, law.parameters))
    >>> found.manipulated, found.initial_state["pump_2.last_output"]
    (('pump_2',), 3.0)
    """
    values, at = designed_values(law, values, point), point.as_dict()
    return Controller(
        name=name,
        family=family,
        design=design,
        law=law,
        values=values,
        initial_state=state_at_rest(law, values, at) if state is None else dict(state),
        measurements=owners(law.inputs, "pv"),
        setpoints=owners(law.inputs, "sp"),
        manipulated=owners(law.outputs, "out"),
        **more,
    )
