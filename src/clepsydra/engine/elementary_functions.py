"""The functions of a kernel beyond arithmetic: straight-line code where there is some."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.engine.arc_functions import arc_cosine, arc_sine
from clepsydra.engine.arc_tangent import arc_tangent, arc_tangent_of_two
from clepsydra.engine.exponential import exponential
from clepsydra.engine.hyperbolic import (
    exponential_minus_one,
    hyperbolic_cosine,
    hyperbolic_sine,
    hyperbolic_tangent,
)
from clepsydra.engine.hypotenuse import hypotenuse
from clepsydra.engine.inverse_hyperbolic import (
    inverse_hyperbolic_cosine,
    inverse_hyperbolic_sine,
    inverse_hyperbolic_tangent,
)
from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.logarithm import logarithm, logarithm_of_one_plus
from clepsydra.engine.power import power
from clepsydra.engine.remainder import remainder
from clepsydra.engine.trigonometric import cosine, sine, tangent
from clepsydra.engine.vector_text import VectorText
from clepsydra.program.operation import LIBRARY

#: The functions that are printed, each with its largest error in units in the last place of the
#: result (1 for a result below 2⁻¹⁰²², which is rounded twice).
_PRINTED: dict[str, tuple[Callable[..., str], float]] = {
    "exp": (exponential, 0.7),
    "log": (logarithm, 0.7),
    "pow": (power, 0.7),
    "asin": (arc_sine, 0.7),
    "acos": (arc_cosine, 0.7),
    "atan": (arc_tangent, 0.75),
    "atan2": (arc_tangent_of_two, 0.8),
    "sinh": (hyperbolic_sine, 0.8),
    "cosh": (hyperbolic_cosine, 0.8),
    "tanh": (hyperbolic_tangent, 0.6),
    "expm1": (exponential_minus_one, 0.7),
    "log1p": (logarithm_of_one_plus, 0.7),
    "sin": (sine, 0.8),
    "cos": (cosine, 0.8),
    "tan": (tangent, 0.95),
    "asinh": (inverse_hyperbolic_sine, 0.8),
    "acosh": (inverse_hyperbolic_cosine, 0.8),
    "atanh": (inverse_hyperbolic_tangent, 0.8),
    "hypot": (hypotenuse, 0.6),
    "fmod": (remainder, 0.0),
    "copysign": (LaneFunction.with_sign_of, 0.0),
}
ERROR_BOUND = {name: bound for name, (_, bound) in _PRINTED.items()}


def elementary_function(text: VectorText, name: str, arguments: Sequence[str]) -> str:
    """Append a function of the mathematical library and return the name of its value.

    The functions in `ERROR_BOUND` are computed in all lanes at once by code that stands in the
    kernel, and so are the same on every machine. The bound says how exact they are: measured at
    hundreds of thousands of points where the error is largest, and rounded up. All others are
    calls of the C library, lane by lane.

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
    if name not in _PRINTED:
        return text.library(name, list(arguments))
    symbol = f"@clepsydra_{name}"
    if symbol not in text.calls:
        _define(text, name, symbol)
    return text.call(symbol, list(arguments))


def _define(text: VectorText, name: str, symbol: str) -> None:
    function = LaneFunction(text.lanes)
    names = ["%x", "%y"][: LIBRARY[name]]
    result = _PRINTED[name][0](function, *names)
    text.define(symbol, function.definition(symbol, names, result))
    text.declarations |= function.declarations
