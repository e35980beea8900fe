"""The functions of a kernel beyond arithmetic: straight-line code where there is some."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.exponential import exponential
from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.logarithm import logarithm
from clepsydra.engine.power import power
from clepsydra.engine.vector_text import VectorText

#: The largest error of the functions printed here, in units in the last place of the result
#: (1 for a result below 2⁻¹⁰²², which is rounded twice).
ERROR_BOUND = {"exp": 0.7, "log": 0.7, "pow": 0.7}


def elementary_function(text: VectorText, name: str, arguments: Sequence[str]) -> str:
    """Append a function of the mathematical library and return the name of its value.

    exp, log and pow are computed in all lanes at once by code that stands in the kernel, and so
    are the same on every machine; `ERROR_BOUND` says how exact they are: measured at hundreds of
    thousands of points where it is largest (0.66), and rounded up. All others are calls of the C
    library, lane by lane.

    Parameters
    ----------
    text : VectorText
        The kernel that is being printed.
    name : str
        A key of `clepsydra.program.program.LIBRARY`.
    arguments : sequence of str
        Names of the arguments' values.

    Examples
    --------
    >>> text = VectorText(4)
    >>> elementary_function(text, "exp", ["%x"])
    '%t1'
    >>> text.lines
    ['  %t1 = call <4 x double> @clepsydra_exp(<4 x double> %x) alwaysinline']
    """
    if name not in ERROR_BOUND:
        return text.library(name, list(arguments))
    symbol = f"@clepsydra_{name}"
    if symbol not in text.calls:
        _define(text, name, symbol)
    return text.call(symbol, list(arguments))


def _define(text: VectorText, name: str, symbol: str) -> None:
    function = LaneFunction(text.lanes)
    names = ["%x", "%y"] if name == "pow" else ["%x"]
    if name == "exp":
        result = exponential(function, "%x")
    elif name == "log":
        result = logarithm(function, "%x")
    else:
        result = power(function, "%x", "%y")
    text.define(symbol, function.definition(symbol, names, result))
    text.declarations |= function.declarations
