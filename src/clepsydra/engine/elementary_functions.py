"""The functions of a kernel beyond arithmetic, as straight-line code."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.engine.arc_functions import arc_cosine, arc_sine
from clepsydra.engine.arc_tangent import arc_tangent, arc_tangent_of_two
from clepsydra.engine.error_function import error_function
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

#: What prints each function, and its largest error in units in the last place of the result (1
#: for a result below 2⁻¹⁰²², which is rounded twice; 0 for a function that is exact).
_PRINTED: dict[str, tuple[Callable[..., str], float]] = {
    "exp": (exponential, 0.7),
    "log": (logarithm, 0.7),
    "pow": (power, 0.7),
    "asin": (arc_sine, 0.75),
    "acos": (arc_cosine, 0.7),
    "atan": (arc_tangent, 0.75),
    "atan2": (arc_tangent_of_two, 0.8),
    "sinh": (hyperbolic_sine, 0.8),
    "cosh": (hyperbolic_cosine, 0.85),
    "tanh": (hyperbolic_tangent, 0.65),
    "expm1": (exponential_minus_one, 0.7),
    "log1p": (logarithm_of_one_plus, 0.7),
    "sin": (sine, 0.85),
    "cos": (cosine, 0.85),
    "tan": (tangent, 0.95),
    "asinh": (inverse_hyperbolic_sine, 0.7),
    "acosh": (inverse_hyperbolic_cosine, 0.7),
    "atanh": (inverse_hyperbolic_tangent, 0.7),
    "erf": (error_function, 0.95),
    "hypot": (hypotenuse, 0.6),
    "fmod": (remainder, 0.0),
    "copysign": (LaneFunction.with_sign_of, 0.0),
}
ERROR_BOUND = {name: bound for name, (_, bound) in _PRINTED.items()}


def elementary_function(text: VectorText, name: str, arguments: Sequence[str]) -> str:
    """Append a function of the mathematical library and return the name of its value.

    They are computed in all lanes at once by code that stands in the kernel, and so are the same
    on every machine. `ERROR_BOUND` says how exact they are: measured at hundreds of thousands of
    points where the error is largest, and rounded up. Not-a-number beyond what such code reaches
    are sin, cos and tan of an angle above `trigonometric.LARGEST_ANGLE`, and fmod of a quotient
    above `remainder.LARGEST_QUOTIENT`.

    Parameters
    ----------
    text : VectorText
        The kernel that is being printed.
    name : str
        A key of `clepsydra.program.operation.LIBRARY`.
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
