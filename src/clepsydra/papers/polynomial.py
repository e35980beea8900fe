"""Sums of products of powers with rational coefficients, in a form that no other sum has."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import floor, gcd, lcm

#: A symbol, or what stands under a root: -1 or a prime.
Base = str | int
#: A product of powers: each base with its exponent, which may be negative or a fraction.
Powers = frozenset[tuple[Base, Fraction]]

_ONE: Powers = frozenset()


@dataclass(frozen=True)
class Polynomial:
    """A sum of products of powers, by these the coefficients, of which none is zero.

    A symbol with a fraction as exponent stands for a positive number. Different products of powers
    are linearly independent over the rational numbers, so that a sum is zero for all values of its
    symbols only if it has no terms: an identity is decided without trying any values.

    References
    ----------
    A. S. Besicovitch, On the linear independence of fractional powers of integers, J. London Math.
    Soc. 15, 1940, pp. 3-6, doi 10.1112/jlms/s1-15.1.3: roots of primes.

    Examples
    --------
    >>> h = Polynomial.of_symbol("h")
    >>> str((h + Polynomial.number(2)) * (h - Polynomial.number(2)))
    'h**2 - 4'
    """

    terms: Mapping[Powers, Fraction]

    @staticmethod
    def number(value: Fraction | int) -> Polynomial:
        """Return a number."""
        return Polynomial({_ONE: Fraction(value)} if value else {})

    @staticmethod
    def of_symbol(name: str) -> Polynomial:
        """Return a symbol."""
        return Polynomial({frozenset({(name, Fraction(1))}): Fraction(1)})

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __add__(self, other: Polynomial) -> Polynomial:
        terms = dict(self.terms)
        for powers, coefficient in other.terms.items():
            terms[powers] = terms.get(powers, Fraction(0)) + coefficient
        return Polynomial({powers: value for powers, value in terms.items() if value})

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + Polynomial.number(-1) * other

    def __mul__(self, other: Polynomial) -> Polynomial:
        terms: dict[Powers, Fraction] = {}
        for one, first in self.terms.items():
            for two, second in other.terms.items():
                powers, factor = _product(one, two)
                terms[powers] = terms.get(powers, Fraction(0)) + first * second * factor
        return Polynomial({powers: value for powers, value in terms.items() if value})

    def __pow__(self, exponent: int) -> Polynomial:
        result = Polynomial.number(1)
        for _ in range(exponent):
            result = result * self
        return result

    def power(self, exponent: Fraction) -> Polynomial:
        """Return a power of a single term; of more only those with whole exponents exist."""
        if exponent.denominator == 1 and exponent >= 0:
            return self ** int(exponent)
        ((powers, coefficient),) = self.terms.items()  # a sum would not be one again
        result = _power(coefficient, exponent)
        for base, power in powers:
            if isinstance(base, int):
                result = result * _power(Fraction(base), power * exponent)
            else:
                result = result * Polynomial({frozenset({(base, power * exponent)}): Fraction(1)})
        return result

    @cached_property
    def bases(self) -> tuple[Base, ...]:
        """Symbols in the order in which a sum is written: roots of numbers, then by name."""
        found = {base for powers in self.terms for base, _ in powers}
        return tuple(sorted(found, key=_place))

    def exponents(self, base: Base) -> set[Fraction]:
        """Return the exponents of a base in the terms."""
        return {dict(powers).get(base, Fraction(0)) for powers in self.terms}

    def coefficients(self, symbol: str) -> dict[Fraction, Polynomial]:
        """Return by powers of a symbol, the highest first, what each is multiplied by."""
        found: dict[Fraction, dict[Powers, Fraction]] = {}
        for powers, value in self.terms.items():
            others = frozenset(each for each in powers if each[0] != symbol)
            found.setdefault(dict(powers).get(symbol, Fraction(0)), {})[others] = value
        return {power: Polynomial(found[power]) for power in sorted(found, reverse=True)}

    def all_coefficients(self, symbol: str) -> list[Polynomial]:
        """Return the coefficients of whole powers of a symbol, the highest first."""
        found, zero = self.coefficients(symbol), Polynomial({})
        return [found.get(Fraction(power), zero) for power in range(int(max(found)), -1, -1)]

    @property
    def value(self) -> Fraction:
        """The number that this is."""
        assert not self.bases, f"{self} is no number"
        return self.terms.get(_ONE, Fraction(0))

    def split(self) -> tuple[Polynomial, Polynomial]:
        """Return a single term and a sum whose product this is, where it is not zero.

        No term divides the sum any further, and its coefficients are whole and have no divisor; the
        first is above zero.
        """
        return self._over({base: min(self.exponents(base)) for base in self.bases})

    def common(self) -> tuple[Polynomial, Polynomial]:
        """Return a single term that all terms share, and the sum that is left.

        As `split`, but a power stays in the sum where it is above the bar in some of its terms and
        below it, or missing, in others: 1 + 1/(T*s) is left as it is.
        """
        shared = {}
        for base in self.bases:
            found = self.exponents(base)
            if min(found) * max(found) > 0:
                shared[base] = min(found, key=abs)
        return self._over(shared)

    def _over(self, shared: Mapping[Base, Fraction]) -> tuple[Polynomial, Polynomial]:
        values = self.terms.values()
        size = Fraction(
            gcd(*(value.numerator for value in values)),
            lcm(*(value.denominator for value in values)),
        )
        if self.terms[self._ordered[0]] < 0:
            size = -size
        powers = frozenset((base, power) for base, power in shared.items() if power)
        unit = Polynomial({powers: size})
        return unit, self * unit.power(Fraction(-1))

    def divided(self, divisor: Polynomial) -> Polynomial | None:
        """Return the quotient of a division without remainder, or None where there is none.

        None too for a divisor with roots of numbers in it, whose terms have no order.
        """
        if any(isinstance(base, int) for base in divisor.bases):
            return None
        if not self:
            return self
        left, found = self, Polynomial({})
        bases = tuple(sorted({*self.bases, *divisor.bases}, key=_place))
        # The quotient of sums has no smaller exponent than the difference of their smallest.
        least = {base: min(self.exponents(base)) - min(divisor.exponents(base)) for base in bases}
        lead = divisor._lead(bases)
        while left:
            term = left._lead(bases) * lead.power(Fraction(-1))
            ((powers, _),) = term.terms.items()
            if any(dict(powers).get(base, 0) < least[base] for base in bases):
                return None
            found, left = found + term, left - term * divisor
        return found

    def _lead(self, bases: Iterable[Base]) -> Polynomial:
        first = max(self.terms, key=lambda powers: [dict(powers).get(base, 0) for base in bases])
        return Polynomial({first: self.terms[first]})

    @cached_property
    def _ordered(self) -> list[Powers]:
        """Its products in the order in which they are written: by the exponents of its bases."""

        def key(powers: Powers) -> list[Fraction | int]:
            return [dict(powers).get(base, 0) for base in self.bases]

        return sorted(self.terms, key=key, reverse=True)

    def __str__(self) -> str:
        ordered = self._ordered
        if len(ordered) == 2 and ordered[1] == _ONE:
            first, last = (self.terms[powers] for powers in ordered)
            if first < 0 < last:  # 1 - x and not -x + 1
                ordered = ordered[::-1]
        words = [_term(self.terms[powers], powers) for powers in ordered]
        joined = itertools.chain(
            words[:1], (f"- {w[1:]}" if w.startswith("-") else f"+ {w}" for w in words[1:])
        )
        return " ".join(joined) or "0"


def _place(base: Base) -> tuple[bool, bool, str]:
    """Roots of numbers stand first, and values of functions last."""
    return isinstance(base, str), "(" in str(base), str(base)


def _product(one: Powers, other: Powers) -> tuple[Powers, Fraction | int]:
    """Return a product of products of powers, and the number that comes out of its roots."""
    if not one or not other:
        return one or other, 1
    powers, factor = dict(one), Fraction(1)
    for base, power in other:
        total = powers.get(base, Fraction(0)) + power
        if isinstance(base, int):
            factor *= Fraction(base) ** floor(total)
            total -= floor(total)
        powers[base] = total
    return frozenset((base, power) for base, power in powers.items() if power), factor


def _power(value: Fraction, exponent: Fraction) -> Polynomial:
    """Return a power of a number: of its primes and its sign, since 8 and 2 have one root."""
    if exponent.denominator == 1:
        return Polynomial.number(value ** int(exponent))
    assert value > 0 or exponent.denominator <= 2, f"({value})**({exponent})"
    result = Polynomial.number(1)
    for whole, up in ((value.numerator, exponent), (value.denominator, -exponent)):
        for prime in _primes(whole):
            times = floor(up)
            root = frozenset({(prime, up - times)} if up != times else ())
            result = result * Polynomial({root: Fraction(prime) ** times})
    return result


def _primes(whole: int) -> list[int]:
    """Return the primes of a number, beside them -1 where it is below zero."""
    found, left, prime = ([-1] if whole < 0 else []), abs(whole), 2
    while left > 1:
        if prime * prime > left:
            prime = left
        while left % prime == 0:
            found.append(prime)
            left //= prime
        prime += 1
    return found


def _term(coefficient: Fraction, powers: Powers) -> str:
    """Return a term as a program has it, "-3*sqrt(2)*x**2/y"."""
    sign = "-" if coefficient < 0 else ""
    return sign + quotient_words(*factors_of_term(coefficient, powers))


def factors_of_term(coefficient: Fraction, powers: Powers) -> tuple[list[str], list[str]]:
    """Return in words what stands above and below the bar of a term, without its sign."""
    above, below = abs(coefficient.numerator), coefficient.denominator
    inverse = frozenset((base, -power) for base, power in powers)
    return (
        [*([str(above)] if above != 1 else []), *_factors(powers)],
        [*([str(below)] if below != 1 else []), *_factors(inverse)],
    )


def _factors(powers: Powers) -> Iterable[str]:
    for base, power in sorted(powers, key=lambda each: _place(each[0])):
        if power == Fraction(1, 2):
            yield f"sqrt({base})"
        elif power > 0:  # the others stand below the bar
            exponent = str(power) if power.denominator == 1 else f"({power})"
            yield str(base) if power == 1 else f"{base}**{exponent}"


def quotient_words(above: list[str], below: list[str]) -> str:
    """Return a quotient of products, in parentheses only where several factors are divided by."""
    over, under = "*".join(above) or "1", "*".join(below)
    if not below:
        return over
    return f"{over}/({under})" if len(below) > 1 else f"{over}/{under}"
