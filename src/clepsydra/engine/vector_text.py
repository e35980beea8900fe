"""LLVM code over lanes: types, constants, memory rows and calls."""

from __future__ import annotations

import struct

#: Compiling a replaced call takes 2 to 10 ms; a call that is kept costs 5 to 25 % more time.
_REPLACED_CALLS = 32


def bits(value: float) -> str:
    """Return a double constant by its bits, which LLVM reads without rounding."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


class VectorText:
    """The lines of one LLVM function whose numbers are vectors of `lanes` doubles.

    Parameters
    ----------
    lanes : int
        1 for plain doubles.
    """

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        self.real = "double" if lanes == 1 else f"<{lanes} x double>"
        self.truth = "i1" if lanes == 1 else f"<{lanes} x i1>"
        self.lines: list[str] = []
        self.label = ""
        self.globals: list[str] = []
        self.declarations: set[str] = set()
        self.calls: dict[str, int] = {}
        self._suffix = "f64" if lanes == 1 else f"v{lanes}f64"
        self._count = 0
        self._labels = 0

    def assign(self, expression: str) -> str:
        """Append an instruction and return the name of its result."""
        self._count += 1
        name = f"%t{self._count}"
        self.lines.append(f"  {name} = {expression}")
        return name

    def line(self, text: str) -> None:
        """Append an instruction without a result, or with a name of its own."""
        self.lines.append(f"  {text}")

    def begin(self, label: str) -> None:
        """Begin a basic block."""
        self.lines.append(f"{label}:")
        self.label = label

    def new_label(self, prefix: str) -> str:
        """Return a label that is not used yet."""
        self._labels += 1
        return f"{prefix}{self._labels}"

    def gap(self) -> int:
        """Leave room for a line that is known later, for `fill`."""
        self.lines.append("")
        return len(self.lines) - 1

    def fill(self, gap: int, text: str) -> None:
        """Write the line that was left open."""
        self.lines[gap] = f"  {text}"

    def row(self, pointer: str, row: str, width: int) -> str:
        """Return the address of a row of `width` vectors."""
        offset = self.assign(f"mul i64 {row}, {width * self.lanes}")
        return self.assign(f"getelementptr double, ptr {pointer}, i64 {offset}")

    def load(self, base: str, index: int = 0) -> str:
        """Load a vector of a row."""
        place = self.assign(f"getelementptr double, ptr {base}, i64 {index * self.lanes}")
        return self.assign(f"load {self.real}, ptr {place}, align 8")

    def store(self, value: str, base: str, index: int = 0) -> None:
        """Store a vector into a row."""
        place = self.assign(f"getelementptr double, ptr {base}, i64 {index * self.lanes}")
        self.line(f"store {self.real} {value}, ptr {place}, align 8")

    def load_spread(self, pointer: str, index: str) -> str:
        """Load one double into every lane."""
        place = self.assign(f"getelementptr double, ptr {pointer}, i64 {index}")
        scalar = self.assign(f"load double, ptr {place}, align 8")
        return self.spread("double", scalar)

    def spread(self, kind: str, scalar: str) -> str:
        """Append one value of a type in every lane."""
        if self.lanes == 1:
            return scalar
        vector = f"<{self.lanes} x {kind}>"
        first = self.assign(f"insertelement {vector} poison, {kind} {scalar}, i32 0")
        return self.assign(
            f"shufflevector {vector} {first}, {vector} poison, <{self.lanes} x i32> zeroinitializer"
        )

    def literal(self, value: float) -> str:
        """Return a constant in every lane."""
        return self.in_every_lane("double", bits(value))

    def all_true(self) -> str:
        """Return the truth value that is true in every lane."""
        return self.in_every_lane("i1", "true")

    def in_every_lane(self, kind: str, constant: str) -> str:
        """Return a constant of a type in every lane."""
        vector = ", ".join([f"{kind} {constant}"] * self.lanes)
        return constant if self.lanes == 1 else f"<{vector}>"

    def negative(self, a: str) -> str:
        """Append −a."""
        return self.assign(f"fneg {self.real} {a}")

    def to_single(self, a: str) -> str:
        """Append a, rounded to single precision."""
        narrow = self.real.replace("double", "float")
        rounded = self.assign(f"fptrunc {self.real} {a} to {narrow}")
        return self.assign(f"fpext {narrow} {rounded} to {self.real}")

    def compare(self, predicate: str, a: str, b: str) -> str:
        """Append a comparison by LLVM's predicate: olt, ole, ogt, oeq, une, …"""
        return self.assign(f"fcmp {predicate} {self.real} {a}, {b}")

    def choose(self, condition: str, a: str, b: str) -> str:
        """Append condition ? a : b."""
        return self.assign(f"select {self.truth} {condition}, {self.real} {a}, {self.real} {b}")

    def in_any_lane(self, condition: str) -> str:
        """Return whether a truth value is true in any lane."""
        if self.lanes == 1:
            return condition
        together = self.assign(f"bitcast {self.truth} {condition} to i{self.lanes}")
        return self.assign(f"icmp ne i{self.lanes} {together}, 0")

    def table(self, symbol: str, entries: tuple[float, ...], alignment: int = 8) -> None:
        """Define a constant array, at a multiple of some bytes."""
        content = ", ".join(f"double {bits(entry)}" for entry in entries)
        self.globals.append(
            f"{symbol} = private constant [{len(entries)} x double] [{content}], align {alignment}"
        )

    def define(self, symbol: str, definition: str) -> None:
        """Define a function beside this one, for `call`."""
        self.calls[symbol] = 0
        self.globals.append(definition)

    def call(self, symbol: str, arguments: list[str]) -> str:
        """Return a call of a function that was defined beside this one.

        The first calls are replaced by the function's code, which then needs no registers saved
        and is shortened where an argument is constant; so many that it costs little to compile.
        """
        self.calls[symbol] += 1
        form = "alwaysinline" if sum(self.calls.values()) <= _REPLACED_CALLS else "noinline"
        given = ", ".join(f"{self.real} {argument}" for argument in arguments)
        return self.assign(f"call {self.real} {symbol}({given}) {form}")

    def intrinsic(self, name: str, arguments: list[str]) -> str:
        """Return a call of an LLVM intrinsic that is exact on every target."""
        symbol = f"@llvm.{name}.{self._suffix}"
        types = ", ".join([self.real] * len(arguments))
        self.declarations.add(f"declare {self.real} {symbol}({types})")
        given = ", ".join(f"{self.real} {argument}" for argument in arguments)
        return self.assign(f"call {self.real} {symbol}({given})")
