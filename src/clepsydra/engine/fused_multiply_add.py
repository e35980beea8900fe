"""a·b + c with one rounding, for machines without the instruction."""

from __future__ import annotations

from clepsydra.engine.lane_function import LaneFunction

#: The function's name, and that of LLVM's that it stands for.
FUSED, INTRINSIC = "@clepsydra_fma", "@llvm.fma.f64"
_WHOLE = "@clepsydra_fma_whole"
_DECLARED = "declare i64 @llvm.ctlz.i64(i64, i1)", "declare i64 @llvm.fshl.i64(i64, i64, i64)"
#: Splits a double into two halves of 26 bits (Veltkamp).
_SPLITTER = 2.0**27 + 1.0
#: Biased exponents of a product that neither overflows on the way nor loses a digit of its error.
_LEAST, _MOST = 1023 - 900, 1023 + 1000
#: More than what rounding may do to a sum, as a share of it.
_MARGIN = 2.0**-51
_EXPONENT, _FRACTION, _SIGN = 0x7FF, (1 << 52) - 1, 1 << 63
_HIDDEN, _INFINITE = 1 << 52, 0x7FF << 52


def fused_multiply_add() -> str:
    """Return the LLVM code of the function, in one lane, out of plain operations.

    The product (Dekker) and its sum with c (Knuth) are taken with their errors, and these are
    added to one rest, with an error of 2⁻⁵³ of it. The sum of both is right where it is the same
    with a rest larger and smaller by more than that (Ziv 1991, doi:10.1145/114697.116813), or
    where that of the sum is zero and so the rest exact. Elsewhere it computes in whole numbers.

    Examples
    --------
    >>> fused_multiply_add().count("define internal double")
    2
    """
    return "\n".join([*_DECLARED, _in_whole_numbers(), _quickly()])


def _quickly() -> str:
    """Return the function itself, by sums with their errors where the result is certain."""
    f = LaneFunction(1)
    f.begin("entry")
    product, product_rest = _product(f, "%a", "%b")
    total, total_rest = f.exact_sum(product, "%c")
    rest = f.add(total_rest, product_rest)
    value = f.add(total, rest)
    least, most = (f.add(total, f.multiply(rest, f.literal(1.0 + e))) for e in (-_MARGIN, _MARGIN))
    above = f.on_bits("sub", _biased(f, f.bits_of(product)), _LEAST)
    sound = f.assign(f"icmp ule i64 {above}, {_MOST - _LEAST}")
    # Where a half of an argument or the sum overflows, the rest is not a number.
    certain = f.compare("oeq", least, most)
    f.line(f"br i1 {f.both(sound, certain)}, label %certain, label %other")
    f.begin("other")
    whole_rest = f.compare("oeq", total_rest, f.literal(0.0))
    whole_rest = f.both(whole_rest, f.compare("ord", value, value))
    f.line(f"br i1 {f.both(sound, whole_rest)}, label %certain, label %uncertain")
    f.begin("certain")
    f.line(f"ret double {value}")
    f.begin("uncertain")
    nothing = f.either(*(f.compare("oeq", x, f.literal(0.0)) for x in ("%a", "%b")))
    f.line(f"br i1 {nothing}, label %nothing, label %whole")
    f.begin("nothing")
    f.line(f"ret double {total}")
    f.begin("whole")
    result = f.assign(f"call double {_WHOLE}(double %a, double %b, double %c)")
    return f.definition(FUSED, ["%a", "%b", "%c"], result).replace("#0", "noinline #0", 1)


def _product(f: LaneFunction, a: str, b: str) -> tuple[str, str]:
    """Append a·b and its error (Dekker 1971, doi:10.1007/BF01397083)."""
    (a_high, a_low), (b_high, b_low) = _halves(f, a), _halves(f, b)
    product = f.multiply(a, b)
    rest = f.subtract(f.multiply(a_high, b_high), product)
    rest = f.add(rest, f.multiply(a_high, b_low))
    rest = f.add(rest, f.multiply(a_low, b_high))
    return product, f.add(rest, f.multiply(a_low, b_low))


def _halves(f: LaneFunction, x: str) -> tuple[str, str]:
    large = f.multiply(f.literal(_SPLITTER), x)
    high = f.add(f.subtract(x, large), large)
    return high, f.subtract(x, high)


def _biased(f: LaneFunction, bits: str) -> str:
    return f.on_bits("and", f.on_bits("lshr", bits, 52), _EXPONENT)


def _in_whole_numbers() -> str:
    """Return the function for any arguments but factors of 0, in 128 bits."""
    f = LaneFunction(1)
    f.begin("entry")
    a, b, c = (f.bits_of(x) for x in ("%a", "%b", "%c"))
    for name, condition, value in _plain_cases(f, a, b, c):
        f.line(f"br i1 {condition}, label %{name}, label %not.{name}")
        f.begin(name)
        f.line(f"ret double {value}")
        f.begin(f"not.{name}")
    (ma, ea), (mb, eb), (mc, ec) = (_mantissa(f, bits) for bits in (a, b, c))
    # Each fills 126 of 128 bits: the product of 106 bits, and c.
    product = _shift(f, "shl", _wide_product(f, ma, mb), 20)
    of_product = f.on_bits("sub", f.on_bits("add", ea, eb), 20)
    addend = _shift(f, "shl", f.assign(f"zext i64 {mc} to i128"), 73)
    of_addend = f.on_bits("sub", ec, 73)
    apart = f.on_bits("sub", of_product, of_addend)
    product_last = f.assign(f"icmp slt i64 {apart}, 0")
    back = f.on_bits("sub", f.whole_literal(0), apart)
    zero = f.whole_literal(0)
    of_both = f.assign(f"select i1 {product_last}, i64 {of_addend}, i64 {of_product}")
    product = _right(f, product, f.assign(f"select i1 {product_last}, i64 {back}, i64 {zero}"))
    addend = _right(f, addend, f.assign(f"select i1 {product_last}, i64 {zero}, i64 {apart}"))
    sign = f.on_bits("and", f.on_bits("xor", a, b), _SIGN)
    sign_c = f.on_bits("and", c, _SIGN)
    alike = f.assign(f"icmp eq i64 {sign}, {sign_c}")
    larger = f.assign(f"icmp uge i128 {product}, {addend}")
    together = f.assign(f"add i128 {product}, {addend}")
    first = f.assign(f"sub i128 {product}, {addend}")
    second = f.assign(f"sub i128 {addend}, {product}")
    difference = f.assign(f"select i1 {larger}, i128 {first}, i128 {second}")
    total = f.assign(f"select i1 {alike}, i128 {together}, i128 {difference}")
    sign = f.assign(f"select i1 {larger}, i64 {sign}, i64 {sign_c}")
    none = f.assign(f"icmp eq i128 {total}, 0")
    f.line(f"br i1 {none}, label %cancelled, label %rounded")
    f.begin("cancelled")
    f.line(f"ret double {f.literal(0.0)}")
    f.begin("rounded")
    rounded = _rounded(f, total, of_both)
    result = f.real_of(f.on_bits("or", rounded, sign))
    return f.definition(_WHOLE, ["%a", "%b", "%c"], result).replace("#0", "noinline #0", 1)


def _plain_cases(f: LaneFunction, a: str, b: str, c: str) -> list[tuple[str, str, str]]:
    """Append what needs no more than a product and a sum: name, condition and value of each."""
    product = f.multiply("%a", "%b")
    plain = f.add(product, "%c")
    special = [f.assign(f"icmp eq i64 {_biased(f, bits)}, {_EXPONENT}") for bits in (a, b, c)]
    return [
        ("infinite", f.either(special[0], special[1]), plain),
        ("open", special[2], f.add("%c", "%c")),
        ("alone", f.compare("oeq", "%c", f.literal(0.0)), product),
    ]


def _mantissa(f: LaneFunction, bits: str) -> tuple[str, str]:
    """Append m of 53 bits and e of |x| = m·2ᵉ, for a finite x that is not zero."""
    fraction, biased = f.on_bits("and", bits, _FRACTION), _biased(f, bits)
    small = f.assign(f"icmp eq i64 {biased}, 0")
    leading = f.assign(f"call i64 @llvm.ctlz.i64(i64 {fraction}, i1 true)")
    up = f.on_bits("sub", leading, 11)
    shifted = f.on_bits("shl", fraction, up)
    normal = f.on_bits("or", fraction, _HIDDEN)
    m = f.assign(f"select i1 {small}, i64 {shifted}, i64 {normal}")
    lowered = f.on_bits("sub", f.whole_literal(1), up)
    e = f.assign(f"select i1 {small}, i64 {lowered}, i64 {biased}")
    return m, f.on_bits("sub", e, 1023 + 52)


def _wide_product(f: LaneFunction, a: str, b: str) -> str:
    """Append the product of two numbers of 53 bits in 128, by halves of 32 bits."""
    mask = 0xFFFFFFFF
    (a0, a1), (b0, b1) = ((f.on_bits("and", x, mask), f.on_bits("lshr", x, 32)) for x in (a, b))
    low, high = f.on_bits("mul", a0, b0), f.on_bits("mul", a1, b1)
    middle = f.on_bits("add", f.on_bits("mul", a0, b1), f.on_bits("mul", a1, b0))
    wide = [f.assign(f"zext i64 {each} to i128") for each in (low, middle, high)]
    total = f.assign(f"add i128 {wide[0]}, {_shift(f, 'shl', wide[1], 32)}")
    return f.assign(f"add i128 {total}, {_shift(f, 'shl', wide[2], 64)}")


def _shift(f: LaneFunction, way: str, x: str, by: int) -> str:
    return f.assign(f"{way} i128 {x}, {by}")


def _right(f: LaneFunction, x: str, by: str) -> str:
    """Append x shifted right by any count, its last bit 1 where a 1 is lost; 128 and more are 127.

    In steps of powers of two: shifts of 128 bits by a variable would be calls of a library.
    """
    far = f.assign(f"icmp ugt i64 {by}, 127")
    by = f.assign(f"select i1 {far}, i64 127, i64 {by}")
    for power in (64, 32, 16, 8, 4, 2, 1):
        lost = f.assign(f"and i128 {x}, {(1 << power) - 1}")
        sticky = f.assign(f"zext i1 {f.assign(f'icmp ne i128 {lost}, 0')} to i128")
        moved = f.assign(f"or i128 {_shift(f, 'lshr', x, power)}, {sticky}")
        asked = f.assign(f"icmp ne i64 {f.on_bits('and', by, power)}, 0")
        x = f.assign(f"select i1 {asked}, i128 {moved}, i128 {x}")
    return x


def _left(f: LaneFunction, upper: str, lower: str, by: str) -> str:
    """Append 128 bits in two halves, shifted left by a count below 128."""
    far = f.assign(f"icmp ugt i64 {by}, 63")
    within = f.on_bits("and", by, 63)
    near = f.assign(f"call i64 @llvm.fshl.i64(i64 {upper}, i64 {lower}, i64 {within})")
    moved = f.on_bits("shl", lower, within)
    upper = f.assign(f"select i1 {far}, i64 {moved}, i64 {near}")
    lower = f.assign(f"select i1 {far}, i64 0, i64 {moved}")
    wide = [f.assign(f"zext i64 {half} to i128") for half in (upper, lower)]
    return f.assign(f"or i128 {_shift(f, 'shl', wide[0], 64)}, {wide[1]}")


def _rounded(f: LaneFunction, total: str, exponent: str) -> str:
    """Append the bits of the double nearest to total·2^exponent, ties to even, without a sign."""
    upper = f.assign(f"trunc i128 {_shift(f, 'lshr', total, 64)} to i64")
    lower = f.assign(f"trunc i128 {total} to i64")
    zeros = [f.assign(f"call i64 @llvm.ctlz.i64(i64 {x}, i1 false)") for x in (upper, lower)]
    empty = f.assign(f"icmp eq i64 {upper}, 0")
    below = f.on_bits("add", zeros[1], 64)
    leading = f.assign(f"select i1 {empty}, i64 {below}, i64 {zeros[0]}")
    filled = _left(f, upper, lower, leading)
    biased = f.on_bits("add", f.on_bits("sub", exponent, leading), 127 + 1023)
    small = f.assign(f"icmp slt i64 {biased}, 1")
    missing = f.on_bits("sub", f.whole_literal(1), biased)
    filled = _right(f, filled, f.assign(f"select i1 {small}, i64 {missing}, i64 0"))
    kept = f.assign(f"trunc i128 {_shift(f, 'lshr', filled, 75)} to i64")
    rest = f.assign(f"and i128 {filled}, {(1 << 75) - 1}")
    half = f.assign(f"icmp eq i128 {rest}, {1 << 74}")
    more = f.assign(f"icmp ugt i128 {rest}, {1 << 74}")
    odd = f.assign(f"trunc i64 {kept} to i1")
    up = f.assign(f"zext i1 {f.either(more, f.both(half, odd))} to i64")
    # The leading bit of a normal number adds one to the exponent, as does a carry.
    field = f.on_bits("shl", f.on_bits("sub", biased, 1), 52)
    field = f.assign(f"select i1 {small}, i64 0, i64 {field}")
    bits = f.on_bits("add", f.on_bits("add", field, kept), up)
    beyond = f.assign(f"icmp sgt i64 {biased}, 2046")
    return f.assign(f"select i1 {beyond}, i64 {_INFINITE}, i64 {bits}")
