"""√x out of multiply-adds, correctly rounded, for where the divider has enough to do."""

from __future__ import annotations

import math

from clepsydra.engine.vector_text import VectorText

#: Between these the residual of a root neither overflows nor loses a digit.
SMALLEST, LARGEST = 2.0**-900, 2.0**1000
#: What makes the largest numbers small enough, and their roots large again.
_FOURTHS, _HALVES = 2.0**-100, 2.0**50
SMALLEST_ENDLESS = SMALLEST / _FOURTHS
#: How far the first approximation may be from 1/√x, as a share of it.
FIRST_ERROR = 2.0**-14
#: Lanes of the instruction that approximates 1/√x.
_WIDTH = 8
_APPROXIMATE = "llvm.x86.avx512.rsqrt14.pd.512"


def can_refine(lanes: int) -> bool:
    """Whether so many lanes are whole vectors of the instruction that begins."""
    return lanes % _WIDTH == 0


def refined_root(text: VectorText, x: str) -> str:
    """Append √x of numbers between `SMALLEST` and `LARGEST`, the double next to it.

    Examples
    --------
    >>> text = VectorText(8)
    >>> name = refined_root(text, "%x")
    >>> sum("@llvm.fma" in line for line in text.lines)
    7
    """
    return improved_root(text, x, _approximate(text, x))


def endless_root(text: VectorText, x: str) -> str:
    """Append √x of numbers from `SMALLEST_ENDLESS` to infinity, by a power of four."""
    smaller = text.assign(f"fmul {text.real} {x}, {text.literal(_FOURTHS)}")
    root = refined_root(text, smaller)
    root = text.assign(f"fmul {text.real} {root}, {text.literal(_HALVES)}")
    endless = text.compare("oeq", x, text.literal(math.inf))
    return text.choose(endless, x, root)


def improved_root(text: VectorText, x: str, near: str) -> str:
    """Append √x from a number within `FIRST_ERROR` of 1/√x.

    With e = 1 − x·near², √x is x·near·(1 + e/2 + 3e²/8 + 5e³/16) but for 2⁻⁵⁴ of itself, so with
    rounding two units in the last place; the residual of that, over 2√x, gives it but for 2⁻⁴⁸ of
    a unit. That decides the rounding of every double whose root is further than that from the
    middle of two doubles; the nearer ones are the squares of odd numbers, a few in 2⁵⁴ beside them,
    and were computed one by one.

    After P. W. Markstein (1990), doi:10.1147/rd.341.0111.
    """
    root = text.assign(f"fmul {text.real} {x}, {near}")
    rest = _multiply_add(text, text.negative(root), near, text.literal(1.0))
    half = text.assign(f"fmul {text.real} {near}, {text.literal(0.5)}")
    share = _multiply_add(text, rest, text.literal(0.3125), text.literal(0.375))
    share = _multiply_add(text, share, rest, text.literal(0.5))
    share = text.assign(f"fmul {text.real} {share}, {rest}")
    root = _multiply_add(text, root, share, root)
    half = _multiply_add(text, half, share, half)
    residual = _multiply_add(text, text.negative(root), root, x)
    return _multiply_add(text, residual, half, root)


def _multiply_add(text: VectorText, a: str, b: str, c: str) -> str:
    return text.intrinsic("fma", [a, b, c])


def _approximate(text: VectorText, x: str) -> str:
    """Append about 1/√x, vector by vector."""
    whole = f"<{_WIDTH} x double>"
    text.declarations.add(f"declare {whole} @{_APPROXIMATE}({whole}, {whole}, i8)")
    found = []
    for first in range(0, text.lanes, _WIDTH):
        part = x
        if text.lanes > _WIDTH:
            places = _places(range(first, first + _WIDTH))
            part = text.assign(f"shufflevector {text.real} {x}, {text.real} poison, {places}")
        given = f"{whole} {part}, {whole} zeroinitializer, i8 -1"
        found.append(text.assign(f"call {whole} @{_APPROXIMATE}({given})"))
    lanes = _WIDTH
    while len(found) > 1:
        kind, places = f"<{lanes} x double>", _places(range(2 * lanes))
        found = [
            text.assign(f"shufflevector {kind} {one}, {kind} {other}, {places}")
            for one, other in zip(found[::2], found[1::2], strict=True)
        ]
        lanes *= 2
    return found[0]


def _places(lanes: range) -> str:
    return f"<{len(lanes)} x i32> <{', '.join(f'i32 {lane}' for lane in lanes)}>"
