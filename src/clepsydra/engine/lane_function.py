"""Builds a small LLVM function over lanes out of arithmetic on doubles and on their bits."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.vector_text import VectorText

#: The bits of a double that its leading 26 binary digits have.
_HEAD = 0xFFFFFFFFF8000000


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

    def exact_sum(self, a: str, b: str) -> tuple[str, str]:
        """Append a + b and what rounding it left over, whichever is larger (Knuth's two-sum)."""
        total = self.add(a, b)
        part = self.subtract(total, a)
        rest = self.subtract(a, self.subtract(total, part))
        return total, self.add(rest, self.subtract(b, part))

    def head(self, x: str) -> str:
        """Append the leading 26 bits of x, whose square is exact."""
        return self.real_of(self.on_bits("and", self.bits_of(x), _HEAD))

    def square_in_two_parts(self, x: str) -> tuple[str, str]:
        """Append x² as the square of its leading bits, exact, and the rest, which is rounded."""
        head = self.head(x)
        rest = self.multiply(self.subtract(x, head), self.add(x, head))
        return self.multiply(head, head), rest

    def quotient(self, above: tuple[str, str], below: tuple[str, str]) -> str:
        """Append the quotient, rounded, of two sums of a number and a smaller one."""
        numerator, denominator = self.add(*above), self.add(*below)
        quotient = self.divide(numerator, denominator)
        missing = self.fused(self.negative(quotient), denominator, numerator)
        above_rest = self.sum_error(*above, numerator)
        below_rest = self.multiply(quotient, self.sum_error(*below, denominator))
        missing = self.add(missing, self.subtract(above_rest, below_rest))
        return self.add(quotient, self.divide(missing, denominator))

    def root_in_two_parts(self, x: str) -> tuple[str, str]:
        """Append the square root of x ≥ 0 as 26 bits and the rest of it, which is rounded."""
        root = self.intrinsic("sqrt", [x])
        head = self.head(root)
        missing = self.subtract(x, self.multiply(head, head))
        return head, self.divide(missing, self._away_from_zero(self.add(root, head)))

    def root_of_sum(self, x: str, rest: str) -> tuple[str, str]:
        """Append the square root of x + rest as that of x, rounded, and what it has beyond."""
        root = self.intrinsic("sqrt", [x])
        missing = self.add(self.fused(self.negative(root), root, x), rest)
        return root, self.divide(missing, self._away_from_zero(self.add(root, root)))

    def _away_from_zero(self, x: str) -> str:
        """Append a number that is x but where that is 0, so that 0 may be divided by it."""
        return self.add(x, self.literal(2.0**-1000))

    def polynomial(self, x: str, coefficients: Sequence[float], *, fused: bool = True) -> str:
        """Append c₀ + c₁x + c₂x² + … in pairs (Estrin's scheme), which shortens the chain.

        Steps that are not fused cost one instruction more where there is a fused one, and a tenth
        where it has to be imitated, as in a page; they will do where the sum is a small part of a
        value.
        """
        terms, power = [self.literal(value) for value in coefficients], x
        step = self.fused if fused else self._rounded_twice
        while True:
            pairs = [step(terms[i + 1], power, terms[i]) for i in range(0, len(terms) - 1, 2)]
            terms = pairs + terms[2 * len(pairs) :]
            if len(terms) == 1:
                return terms[0]
            power = self.multiply(power, power)

    def _rounded_twice(self, a: str, b: str, c: str) -> str:
        return self.add(self.multiply(a, b), c)

    def magnitude(self, x: str) -> str:
        """Append |x|."""
        return self.intrinsic("fabs", [x])

    def with_sign_of(self, size: str, sign: str) -> str:
        """Append |size| with the sign of the second value, that of a zero too."""
        return self.intrinsic("copysign", [size, sign])

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

    def any_bit(self, bits: str) -> str:
        """Append the truth value: some bit of a whole number is set."""
        return self.assign(f"icmp ne {self.whole} {bits}, {self.whole_literal(0)}")
