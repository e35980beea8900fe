"""The numbers that a design gives to its law: rounded as they are shown, and within the ranges."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.key import ratio_of_units
from clepsydra.base.rounding import rounded, rounded_matrix
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.parameters import check_parameters
from clepsydra.controllers.pid_keys import GAINS
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.gain_units import gain_from_percent, percent_gain
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.program.step_law import StepLaw

_DIGITS = 9


def designed_values(
    law: StepLaw, values: Mapping[str, float], point: OperatingPoint
) -> dict[str, float]:
    """Return what a design found, rounded: the controller runs with the numbers that are read.

    Each parameter has the significant digits that its signal says, six where it says nothing;
    the gains of a PID loop have them in %/%. A number of a matrix that is nothing beside the
    others, each in shares of the ranges that it joins, is zero. What the process file or the
    operating point says is no result of a design and stays.

    Parameters
    ----------
    values : mapping
        Parameter name to value, in the law's units.
    point : OperatingPoint
        That of the design; its process lends the ranges.

    Raises
    ------
    NotApplicable
        No controller could run with a number.
    """
    return applicable_values(law, rounded_values(law, values, point))


def applicable_values(law: StepLaw, values: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers as they are, for a search, which needs them to change smoothly.

    Raises
    ------
    NotApplicable
        No controller could run with a number.

    Examples
    --------
    See `designed_values`.
    """
    try:
        check_parameters(law, values, "design")
    except InputError as error:
        name = error.place.rpartition(", ")[2]
        raise NotApplicable(
            f"its {name} would be {values[name]:.3g}, and a controller takes {error.expected}"
        ) from None
    return dict(values)


def rounded_values(
    law: StepLaw, values: Mapping[str, float], point: OperatingPoint
) -> dict[str, float]:
    """Return the numbers as `designed_values` rounds them, whether or not a law takes them.

    Examples
    --------
    See `designed_values`.
    """
    loops = {
        path(block.owner, gain): (block.measurement, block.moved)
        for block in law.blocks
        if isinstance(block, PidBlock) and block.measurement.has_range and block.moved.has_range
        for gain in GAINS
    }
    return rounded_numbers(law.parameters, values, point, loops)


def rounded_numbers(
    entries: Sequence[Signal],
    numbers: Mapping[str, float],
    point: OperatingPoint,
    loops: Mapping[str, tuple[Signal, Signal]] | None = None,
) -> dict[str, float]:
    """Return the numbers of parameters or states, rounded as `designed_values` does.

    Parameters
    ----------
    loops : mapping, optional
        Gain to the measurement and the moved signal of whose percent it has its digits.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> row = [Signal(f"pump.feedback.{name}", "V/V", matrix="feedback") for name in "xy"]
    >>> rounded_numbers(row, {"pump.feedback.x": 2.0 / 3.0, "pump.feedback.y": 1e-16}, point)
    {'pump.feedback.x': 0.666667, 'pump.feedback.y': 0.0}
    """
    given, units = _given(point), _sizes_of_units(point.process)
    found, largest = dict(numbers), dict[str, float]()
    designed = [entry for entry in entries if numbers[entry.name] not in given]
    for entry in designed:
        share = abs(numbers[entry.name]) / units.get(entry.unit, 1.0)
        largest[kind(entry)] = max(largest.get(kind(entry), 0.0), share)
    for entry in designed:
        number = float(numbers[entry.name])
        ends = (loops or {}).get(entry.name)
        if ends is not None:
            percent = rounded(percent_gain(number, *ends), entry.digits)
            found[entry.name] = gain_from_percent(percent, *ends)
        else:
            size = largest[kind(entry)] * units.get(entry.unit, 1.0)
            found[entry.name] = rounded(number, entry.digits, size)
    return found


def rounded_symmetric(matrix: np.ndarray) -> np.ndarray:
    """Return a covariance or a cost, rounded in shares of the roots of its diagonal.

    Examples
    --------
    >>> rounded_symmetric(np.array([[4e6 / 3.0, 1e-12], [1e-12, 1e-6 / 3.0]])).tolist()
    [[1333333.33, 0.0], [0.0, 3.33333333e-07]]
    """
    roots = np.sqrt(np.abs(np.diag(matrix)))
    return rounded_matrix(matrix, _DIGITS, np.outer(roots, roots))


def kind(parameter: Signal) -> str:
    """Return the matrix or vector that a number is one of, or what it is of its owner.

    Examples
    --------
    >>> kind(Signal("pump.feedback.level", matrix="feedback")), kind(Signal("pump.bias"))
    ('feedback', 'bias')
    """
    of_vector = parameter.part.isdigit()
    return parameter.matrix or (Signal(parameter.owner).part if of_vector else parameter.part)


def _given(point: OperatingPoint) -> set[float]:
    """Return the numbers of the process and of its operating point."""
    process = point.process
    signals: Iterable[Signal] = (*process.state, *process.inputs, *process.measurements)
    ends = [end for signal in signals for end in (signal.low, signal.high)]
    return {*point.as_dict().values(), *map(float, process.parameter_values), *ends}


def _sizes_of_units(process: Process) -> dict[str, float]:
    """Return for the units of gains what is large: the ranges that they join."""
    spans: dict[str, float] = {}
    for signal in (*process.state, *process.inputs, *process.measurements):
        if math.isfinite(signal.span) and signal.span > 0.0:
            spans[signal.unit] = max(spans.get(signal.unit, 0.0), signal.span)
    sizes = dict(spans)
    for above, height in spans.items():
        for below, width in spans.items():
            sizes[ratio_of_units(above, below)] = height / width
            sizes[ratio_of_units(above, below, "s")] = height / width
    return sizes | {"1": 1.0}
