"""A sampled transfer function with whole samples of delay: G = z^-d B(z^-1) / A(z^-1)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.words import SUPERSCRIPTS

#: A root this near to the unit circle stands on it, and one this near to 1 integrates.
ON_THE_CIRCLE = 1e-8


@dataclass(frozen=True)
class SampledModel:
    """y(k) = −a1 y(k−1) − … − an y(k−n) + b1 u(k−1−d) + … + bm u(k−m−d).

    Parameters
    ----------
    numerator : tuple of float
        b1 … bm [output unit / input unit]. There is no b0: what is computed in a sample is not
        seen before the next one.
    denominator : tuple of float
        a1 … an.
    delay : int
        d [samples]
    period : float
        T0 [s]

    Raises
    ------
    InputError
        A coefficient is no finite number, all of B are zero, the delay is no whole number of
        samples or negative, or the period is not above zero.

    Examples
    --------
    A tank with a gain of 2 and a time constant of ten samples, after three samples of delay:

    >>> pole = math.exp(-0.1)
    >>> tank = SampledModel((2 * (1 - pole),), (-pole,), delay=3, period=1.0)
    >>> round(tank.static_gain, 9), tank.is_stable
    (2.0, True)
    """

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    delay: int
    period: float

    def __post_init__(self) -> None:
        for name in ("numerator", "denominator"):
            given = getattr(self, name)
            for value in given:
                if not is_finite_number(value):
                    place = f"sampled model, {name}"
                    raise InputError(place, value, "finite numbers", "correct it")
            object.__setattr__(self, name, tuple(float(value) for value in given))
        if not any(self.numerator):
            expected = "a coefficient that is not zero"
            remedy = "give b1, b2, … of an input that moves the output"
            raise InputError("sampled model, numerator", list(self.numerator), expected, remedy)
        if not is_finite_number(self.period) or self.period <= 0.0:
            place, expected = "sampled model, period", "a time above 0 s"
            raise InputError(place, self.period, expected, "give it in seconds")
        if not isinstance(self.delay, (int, np.integer)) or self.delay < 0:
            expected = "a whole number of samples from 0 on"
            remedy = "sample so that the delay is a multiple of the period, or round it up"
            raise InputError("sampled model, delay", self.delay, expected, remedy)
        object.__setattr__(self, "delay", int(self.delay))

    @property
    def order(self) -> int:
        """n, of A."""
        return len(self.denominator)

    @cached_property
    def A(self) -> np.ndarray:
        """1, a1 … an."""
        return np.array([1.0, *self.denominator])

    @cached_property
    def B(self) -> np.ndarray:
        """0, b1 … bm."""
        return np.array([0.0, *self.numerator])

    @cached_property
    def poles(self) -> np.ndarray:
        """Roots of z^n A(1/z), the slowest first."""
        roots = np.roots(self.A).astype(complex)
        return roots[np.argsort(-np.abs(roots), kind="stable")]

    @cached_property
    def zeros(self) -> np.ndarray:
        """Roots of z^m B(1/z)."""
        return np.roots(np.trim_zeros(self.B, "f")).astype(complex)

    @property
    def is_integrating(self) -> bool:
        """Whether a pole stands at 1."""
        return bool(np.any(np.abs(self.poles - 1.0) <= ON_THE_CIRCLE))

    @property
    def is_stable(self) -> bool:
        """Whether every pole stands inside the unit circle."""
        return bool(np.max(np.abs(self.poles), initial=0.0) < 1.0 - ON_THE_CIRCLE)

    @property
    def static_gain(self) -> float:
        """B(1)/A(1) [output unit / input unit]; infinite for an integrating model."""
        if self.is_integrating:
            return math.inf
        return math.fsum(self.B) / math.fsum(self.A)

    def output(self, signal: np.ndarray) -> np.ndarray:
        """Return y from rest [… , N] for an input u [… , N], along the last axis."""
        from scipy.signal import lfilter

        shifted = np.zeros_like(np.asarray(signal, dtype=float))
        if self.delay < shifted.shape[-1]:
            shifted[..., self.delay :] = np.asarray(signal)[..., : shifted.shape[-1] - self.delay]
        return np.asarray(lfilter(self.B, self.A, shifted, axis=-1))

    def response(self, z: np.ndarray) -> np.ndarray:
        """Return G at points z of the complex plane."""
        back = 1.0 / np.asarray(z, dtype=complex)
        shape = np.polyval(self.B[::-1], back) / np.polyval(self.A[::-1], back)
        return np.asarray(shape * back**self.delay)

    def in_words(self) -> str:
        """Return it as a reader writes it."""
        above = _polynomial(self.numerator, 1)
        below = "1" + _polynomial(self.denominator, 1, signed=True)
        delayed = f" {_back(self.delay)}" if self.delay else ""
        return f"({above}) / ({below}){delayed}"


def _polynomial(coefficients: Sequence[float], first: int, *, signed: bool = False) -> str:
    words = ""
    for power, value in enumerate(coefficients, start=first):
        sign = "−" if value < 0.0 else "+"
        lead = f" {sign} " if words or signed else ("−" if value < 0.0 else "")
        words += f"{lead}{abs(value):.6g} {_back(power)}"
    return words


def _back(samples: int) -> str:
    """Return the shift that looks back so many samples."""
    return f"z{str(-samples).translate(SUPERSCRIPTS)}"
