"""Tables 6 to 8 as printed: integral indices of C [kmol/m³] and V [m³] after the steps."""

from __future__ import annotations

from clepsydra.papers.averaging_tank import PRINTED

#: Index and output, as the tables have them.
KEYS = tuple((index, output) for index in ("IAE", "ISE", "ITAE", "IE") for output in ("C", "V"))
#: IAE of C in Table 8 without its misprint, which is judged in its own row.
IAE_OF_C = 8.80e-3

Indices = dict[tuple[str, str], float]


def printed_indices(table: str, column: str = "") -> Indices:
    """Return the sizes in a column of a table."""
    ending = f", {column}" if column else ""
    lines = {key: PRINTED[table, f"{key[0]} of {key[1]}{ending}"] for key in KEYS}
    return {key: abs(line.value) for key, line in lines.items()}


#: Sizes in Table 6 and, optimal, in Table 7 with f_out constant, and in Table 8, IAE of C with
#: the exponent that its IE asks for.
PI_INDICES = printed_indices("Table 6", "f_out constant")
LQI_INDICES = printed_indices("Table 7", "f_out constant, optimal")
FUZZY_INDICES = printed_indices("Table 8") | {("IAE", "C"): IAE_OF_C}


def lower_cells(ours: Indices, theirs: Indices) -> list[str]:
    """Name the cells in which our indices are lower."""
    return [f"{i} of {output}" for (i, output), value in theirs.items() if ours[i, output] < value]
