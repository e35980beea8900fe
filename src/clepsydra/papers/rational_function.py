"""Quotients of sums: derived as a document derives them, and equal where nothing is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import prod
from numbers import Rational
from typing import Any

from clepsydra.papers.polynomial import Polynomial, factors_of_term, quotient_words

_ONE = Polynomial.number(1)


@dataclass(frozen=True, eq=False)
class RationalFunction:
    """A sum over a product of sums.

    Two are equal where their numerators over a common denominator are, which decides it for all
    values of the symbols. Common factors are divided out where one is a factor of the denominator
    as it came about; that is for the reader, and no equality rests on it.

    Parameters
    ----------
    numerator : Polynomial
    factors : mapping
        Of the denominator, each of more than one term and with its power.

    Examples
    --------
    >>> s, K = symbols("s K")
    >>> loop = K / s
    >>> loop / (1 + loop), loop / (1 + loop) == K / (K + s)
    (K/(K + s), True)
    """

    numerator: Polynomial
    factors: Mapping[Polynomial, int] = field(default_factory=dict)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _OPERANDS):
            return NotImplemented
        other = exact(other)
        powers = self._common(other)
        return self._over(powers) == other._over(powers)

    def __add__(self, other: Any) -> RationalFunction:
        if not isinstance(other, _OPERANDS):
            return NotImplemented
        other = exact(other)
        powers = self._common(other)
        return _reduced(self._over(powers) + other._over(powers), powers)

    def __mul__(self, other: Any) -> RationalFunction:
        if not isinstance(other, _OPERANDS):
            return NotImplemented
        other = exact(other)
        powers = {
            factor: self.factors.get(factor, 0) + other.factors.get(factor, 0)
            for factor in {**self.factors, **other.factors}
        }
        return _reduced(self.numerator * other.numerator, powers)

    def __neg__(self) -> RationalFunction:
        return -1 * self

    def __sub__(self, other: Any) -> RationalFunction:
        return self + -1 * other

    def __rsub__(self, other: Any) -> RationalFunction:
        return -1 * self + other

    def __truediv__(self, other: Any) -> RationalFunction:
        if not isinstance(other, _OPERANDS):
            return NotImplemented
        return self * exact(other)._inverse()

    def __rtruediv__(self, other: Any) -> RationalFunction:
        return self._inverse() * other

    def __pow__(self, exponent: Fraction | int) -> RationalFunction:
        whole = Fraction(exponent)
        if whole.denominator != 1:  # of a single term
            assert not self.factors, f"({self})**({exponent})"
            return RationalFunction(self.numerator.power(whole))
        base = self if whole >= 0 else self._inverse()
        return prod([base] * abs(int(whole)), start=exact(1))

    __radd__ = __add__
    __rmul__ = __mul__

    def _inverse(self) -> RationalFunction:
        if not self.numerator:
            raise ZeroDivisionError(f"1/({self})")
        unit, rest = self.numerator.split()
        powers = {rest: 1} if rest != _ONE else {}
        return _reduced(self._factors_multiplied * unit.power(Fraction(-1)), powers)

    def _common(self, other: RationalFunction) -> Mapping[Polynomial, int]:
        """Return the factors of a common denominator."""
        return {
            factor: max(self.factors.get(factor, 0), other.factors.get(factor, 0))
            for factor in {**self.factors, **other.factors}
        }

    def _over(self, powers: Mapping[Polynomial, int]) -> Polynomial:
        """Return the numerator over a denominator of more factors."""
        missing = (factor ** (powers[factor] - self.factors.get(factor, 0)) for factor in powers)
        return prod(missing, start=self.numerator)

    @property
    def _factors_multiplied(self) -> Polynomial:
        return prod((factor**power for factor, power in self.factors.items()), start=_ONE)

    @property
    def symbols(self) -> set[str]:
        """Names of the symbols on which it depends."""
        sums = (self.numerator, *self.factors)
        return {base for each in sums for base in each.bases if isinstance(base, str)}

    @property
    def denominator(self) -> Polynomial:
        """What stands below the bar, multiplied out, with no exponent below zero."""
        if not self.numerator:
            return _ONE
        ((powers, coefficient),) = self.numerator.split()[0].terms.items()
        below = frozenset((base, -power) for base, power in powers if power < 0)
        return self._factors_multiplied * Polynomial({below: Fraction(coefficient.denominator)})

    @property
    def number(self) -> Fraction:
        """The number that this is."""
        assert not self.factors, f"{self} is no number"
        return self.numerator.value

    def __float__(self) -> float:
        return float(self.number)

    def derivative(self, symbol: str) -> RationalFunction:
        """Return the derivative by a symbol."""
        moved = _derivative(self.numerator, symbol) * RationalFunction(_ONE, self.factors)
        return moved - sum(
            power * self * _derivative(factor, symbol) / RationalFunction(factor)
            for factor, power in self.factors.items()
        )

    def with_values(self, values: Mapping[str, Any]) -> RationalFunction:
        """Return what it is with other expressions, or numbers, for some symbols."""
        found = {name: exact(value) for name, value in values.items()}
        below = (_with_values(factor, found) ** -power for factor, power in self.factors.items())
        return prod(below, start=_with_values(self.numerator, found))

    def root(self, symbol: str) -> RationalFunction:
        """Return the value of a symbol at which this is zero, where it is linear in it."""
        slope = self.derivative(symbol)
        assert symbol not in slope.symbols, f"{self} is not linear in {symbol}"
        return -self.with_values({symbol: 0}) / slope

    def __str__(self) -> str:
        if self.denominator == _ONE:
            return str(self.numerator)
        unit, rest = self.numerator.split() if self.factors else self.numerator.common()
        ((powers, coefficient),) = unit.terms.items()
        above, below = factors_of_term(coefficient, powers)
        for factor, power in self.factors.items():
            below.append(f"({factor})**{power}" if power > 1 else f"({factor})")
        sign = "-" if coefficient < 0 else ""
        if rest != _ONE:
            if sign and min(rest.terms.values()) < 0:
                sign, rest = "", Polynomial.number(-1) * rest
            above.append(f"({rest})" if above or below else str(rest))
        return sign + quotient_words(above, below)

    __repr__ = __str__


#: What an expression is added to, or multiplied with.
_OPERANDS = (RationalFunction, Rational)


def symbols(names: str) -> tuple[RationalFunction, ...]:
    """Return symbols by their names, with spaces between them."""
    return tuple(map(symbol, names.split()))


def symbol(name: str) -> RationalFunction:
    """Return one symbol, in whose name there may be spaces."""
    return RationalFunction(Polynomial.of_symbol(name))


def exact(value: object) -> RationalFunction:
    """Return an expression, or a whole number or a fraction as one."""
    if isinstance(value, RationalFunction):
        return value
    if isinstance(value, Rational):
        return RationalFunction(
            Polynomial.number(Fraction(int(value.numerator), int(value.denominator)))
        )
    raise TypeError(f"{value!r} is no exact number")


def square_root(value: Any) -> RationalFunction:
    """Return the root of a single term, whose symbols are above zero."""
    return exact(value) ** Fraction(1, 2)


def _reduced(numerator: Polynomial, powers: Mapping[Polynomial, int]) -> RationalFunction:
    left = {}
    for factor, power in powers.items():
        while power and (quotient := numerator.divided(factor)) is not None:
            numerator, power = quotient, power - 1
        if power:
            left[factor] = power
    return RationalFunction(numerator, left)


def _derivative(of: Polynomial, symbol: str) -> RationalFunction:
    by = Polynomial.of_symbol(symbol)
    return RationalFunction(
        sum(
            (
                Polynomial.number(power) * factor * by.power(power - 1)
                for power, factor in of.coefficients(symbol).items()
                if power
            ),
            start=Polynomial({}),
        )
    )


def _with_values(of: Polynomial, values: Mapping[str, RationalFunction]) -> RationalFunction:
    result = exact(0)
    for powers, coefficient in of.terms.items():
        kept = frozenset(each for each in powers if each[0] not in values)
        replaced = [values[str(base)] ** power for base, power in powers - kept]
        result += prod(replaced, start=RationalFunction(Polynomial({kept: coefficient})))
    return result
