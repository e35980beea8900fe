"""Builds a small LLVM function over lanes out of arithmetic on doubles and on their bits."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.vector_text import VectorText


class LaneFunction(VectorText):
    """A function without branches, computed in every lane.

    The same instructions stand in one lane and in many, and none may be reordered or fused by
    the compiler, so a value does not depend on the number of lanes.

    Examples
    --------
    >>> function = LaneFunction(1)
    >>> result = function.multiply("%x", function.literal(2.0))
    >>> print(function.definition("@twice", ["%x"], result))
    define internal double @twice(double %x) #0 {
      %t1 = fmul double %x, 0x4000000000000000
      ret double %t1
    }
    """

    def __init__(self, lanes: int) -> None:
        super().__init__(lanes)
        self.whole = "i64" if lanes == 1 else f"<{lanes} x i64>"

    def definition(self, symbol: str, arguments: Sequence[str], result: str) -> str:
        """Return the text of the function.

        Parameters
        ----------
        symbol : str
        arguments : sequence of str
            Names of the arguments, all of them reals.
        result : str
            Name of the value that is returned.
        """
        given = ", ".join(f"{self.real} {argument}" for argument in arguments)
        return "\n".join(
            [
                f"define internal {self.real} {symbol}({given}) #0 {{",
                *self.lines,
                f"  ret {self.real} {result}",
                "}",
            ]
        )

    def add(self, a: str, b: str) -> str:
        """Append a + b."""
        return self.assign(f"fadd {self.real} {a}, {b}")

    def subtract(self, a: str, b: str) -> str:
        """Append a − b."""
        return self.assign(f"fsub {self.real} {a}, {b}")

    def multiply(self, a: str, b: str) -> str:
        """Append a·b."""
        return self.assign(f"fmul {self.real} {a}, {b}")

    def divide(self, a: str, b: str) -> str:
        """Append a / b."""
        return self.assign(f"fdiv {self.real} {a}, {b}")

    def fused(self, a: str, b: str, c: str) -> str:
        """Append a·b + c with one rounding; without the instruction, the C library's fma."""
        return self.intrinsic("fma", [a, b, c])

    def product_error(self, a: str, b: str, product: str) -> str:
        """Append a·b − product, which is exact where the product is a·b rounded."""
        return self.fused(a, b, self.negative(product))

    def sum_error(self, a: str, b: str, total: str) -> str:
        """Append (a + b) − total, exact for |a| ≥ |b| or a = 0 (Dekker's fast two-sum)."""
        return self.add(self.subtract(a, total), b)

    def polynomial(self, x: str, coefficients: Sequence[float]) -> str:
        """Append c₀ + c₁x + c₂x² + … in pairs (Estrin's scheme), which shortens the chain."""
        terms, power = [self.literal(value) for value in coefficients], x
        while True:
            pairs = [self.fused(terms[i + 1], power, terms[i]) for i in range(0, len(terms) - 1, 2)]
            terms = pairs + terms[2 * len(pairs) :]
            if len(terms) == 1:
                return terms[0]
            power = self.multiply(power, power)

    def both(self, a: str, b: str) -> str:
        """Append the truth value a and b."""
        return self.assign(f"and {self.truth} {a}, {b}")

    def either(self, a: str, b: str) -> str:
        """Append the truth value a or b."""
        return self.assign(f"or {self.truth} {a}, {b}")

    def limit(self, x: str, low: float, high: float) -> str:
        """Append x limited to [low, high]; not-a-number stays what it is."""
        top, bottom = self.literal(high), self.literal(low)
        x = self.choose(self.compare("ogt", x, top), top, x)
        return self.choose(self.compare("olt", x, bottom), bottom, x)

    def whole_literal(self, value: int) -> str:
        """Return a whole number modulo 2⁶⁴ in every lane."""
        return self.in_every_lane("i64", str(value & 0xFFFFFFFFFFFFFFFF))

    def bits_of(self, x: str) -> str:
        """Append the bits of a real as a whole number."""
        return self.assign(f"bitcast {self.real} {x} to {self.whole}")

    def real_of(self, x: str) -> str:
        """Append the real that has these bits."""
        return self.assign(f"bitcast {self.whole} {x} to {self.real}")

    def on_bits(self, operation: str, a: str, b: str | int) -> str:
        """Append a whole operation (add, sub, and, or, shl, lshr), modulo 2⁶⁴."""
        other = b if isinstance(b, str) else self.whole_literal(b)
        return self.assign(f"{operation} {self.whole} {a}, {other}")
