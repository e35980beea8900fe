"""The functions of a library in 60 correct digits and more, from Python's decimal arithmetic."""

from decimal import Context, Decimal, localcontext
from functools import cache

#: Doubles as small as 2⁻⁷⁰ lose 60 of these digits in the formulas below, and 60 are left.
DIGITS = Context(prec=130, Emin=-(10**9), Emax=10**9)
_NEGLIGIBLE = Decimal(10) ** -125


def exact(name: str, *arguments: float) -> Decimal:
    """Return a function of `clepsydra.program.operation.LIBRARY` at doubles."""
    with localcontext(DIGITS):
        return _FORMULAS[name](*(Decimal(float(x)) for x in arguments))


def _arc_tangent(x: Decimal) -> Decimal:
    """Two halvings of the angle and the series of arctan."""
    if abs(x) > 1:
        return (pi() / 2).copy_sign(x) - _arc_tangent(1 / x)
    t = x
    for _ in range(2):
        t = t / (1 + (1 + t * t).sqrt())
    return 4 * _arc_tangent_series(t)


def _arc_tangent_series(t: Decimal) -> Decimal:
    total, power, k = Decimal(0), t, 1
    while abs(power) > _NEGLIGIBLE * abs(t):
        total, power, k = total + power / k, -power * t * t, k + 2
    return total


@cache
def pi() -> Decimal:
    """Machin's formula."""
    with localcontext(DIGITS):
        return 16 * _arc_tangent_series(1 / Decimal(5)) - 4 * _arc_tangent_series(1 / Decimal(239))


def _sine_and_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    quadrant = (x / (pi() / 2)).to_integral_value()
    r = x - quadrant * (pi() / 2)
    sums, term, k = [Decimal(0), Decimal(0)], Decimal(1), 0
    while abs(term) > _NEGLIGIBLE * min(abs(r), 1):
        sums[k % 2] += -term if k % 4 > 1 else term
        k += 1
        term = term * r / k
    cosine, sine = sums
    for _ in range(int(quadrant % 4) % 4):
        sine, cosine = cosine, -sine
    return sine, cosine


def _tangent(x: Decimal) -> Decimal:
    sine, cosine = _sine_and_cosine(x)
    return sine / cosine


def _angle(y: Decimal, x: Decimal) -> Decimal:
    angle = _arc_tangent(y / x) if x else (pi() / 2).copy_sign(y)
    return angle if x >= 0 else angle + pi().copy_sign(y)


def _arc_sine(x: Decimal) -> Decimal:
    return _angle(x, ((1 - x) * (1 + x)).sqrt())


def _arc_cosine(x: Decimal) -> Decimal:
    return _angle(((1 - x) * (1 + x)).sqrt(), x)


def _hyperbolic_sine(x: Decimal) -> Decimal:
    return (x.exp() - (-x).exp()) / 2


def _hyperbolic_cosine(x: Decimal) -> Decimal:
    return (x.exp() + (-x).exp()) / 2


def _error_function(x: Decimal) -> Decimal:
    total, term, n = Decimal(0), x, 0
    while abs(term) > _NEGLIGIBLE * abs(x):
        total, n = total + term / (2 * n + 1), n + 1
        term = -term * x * x / n
    return 2 * total / pi().sqrt()


_FORMULAS = {
    "exp": Decimal.exp,
    "log": Decimal.ln,
    "pow": lambda x, y: x**y,
    "sin": lambda x: _sine_and_cosine(x)[0],
    "cos": lambda x: _sine_and_cosine(x)[1],
    "tan": _tangent,
    "asin": _arc_sine,
    "acos": _arc_cosine,
    "atan": _arc_tangent,
    "atan2": _angle,
    "sinh": _hyperbolic_sine,
    "cosh": _hyperbolic_cosine,
    "tanh": lambda x: _hyperbolic_sine(x) / _hyperbolic_cosine(x),
    "expm1": lambda x: x.exp() - 1,
    "log1p": lambda x: (1 + x).ln(),
    "asinh": lambda x: (abs(x) + (x * x + 1).sqrt()).ln().copy_sign(x),
    "acosh": lambda x: (x + ((x - 1) * (x + 1)).sqrt()).ln(),
    "atanh": lambda x: ((1 + x) / (1 - x)).ln() / 2,
    "erf": _error_function,
    "hypot": lambda x, y: (x * x + y * y).sqrt(),
}
