"""One function of a library in a kernel of its own, and how far its values are from the truth."""

import math
from fractions import Fraction
from functools import cache

import casadi as ca
import numpy as np
from exact_functions import exact

from clepsydra import Kernel, Signal, program_of
from clepsydra.program.operation import LIBRARY
from clepsydra.program.step_law import Equations, StepLaw, step_law

_CALLS = {"pow": lambda x, y: x**y}


@cache
def law(name: str) -> StepLaw:
    """Return the law whose output y is the function of its inputs."""
    call = _CALLS.get(name) or getattr(ca, name)
    names = ("a", "b")[: LIBRARY[name]]
    return step_law(
        f"law_of_{name}",
        inputs=[Signal(argument) for argument in names],
        parameters=[],
        state=[],
        outputs=[Signal("y")],
        equations=lambda s: Equations({}, {"y": call(*(s[argument] for argument in names))}),
    )


@cache
def _kernel(name: str, lanes: int) -> Kernel:
    names = ["a", "b"][: LIBRARY[name]]
    return Kernel(program_of(law(name)), individual=names, lanes=lanes)


def computed(name, *arguments, lanes=8):
    """Return the function's values in a kernel, each in a lane of its own."""
    columns = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in arguments))
    inputs = {n: x.reshape(-1, 1) for n, x in zip("ab", columns, strict=False)}
    return _kernel(name, lanes).run(1, inputs=inputs, threads=1).output("y")[:, 0]


def error(value, truth):
    """Return |value − truth| in units in the last place of a double at `truth`."""
    size = abs(Fraction(truth))
    near = float(size)
    unit = math.ulp(near)
    if Fraction(near) > size and math.frexp(near)[0] == 0.5 and near > 2.0**-1022:
        unit /= 2
    return float(abs(Fraction(float(value)) - Fraction(truth)) / Fraction(unit))


def worst(name, *arguments):
    """Return the largest error of a function at many points."""
    columns = np.broadcast_arrays(*arguments)
    values = computed(name, *columns)
    return max(error(v, exact(name, *x)) for v, *x in zip(values, *columns, strict=True))


def around(centres, spread, count, seed):
    """Return numbers within a relative spread of some centres."""
    random = np.random.default_rng(seed)
    return random.choice(centres, count) * (1 + spread * random.uniform(-1, 1, count))


def same(value, expected):
    """Whether two doubles are equal, with the sign of a zero, or both not a number."""
    if math.isnan(expected):
        return math.isnan(value)
    return value == expected and math.copysign(1, value) == math.copysign(1, expected)
