"""What a document prints: the table of its numbers and words, and what digits leave open."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from importlib import resources

_NUMBER = re.compile(r"([+\-−]?)(\d*)\.?(\d*)(?:[eE]([+\-−]?\d+))?")


@dataclass(frozen=True)
class PrintedNumber:
    """A printed number, and half a unit of its last digit: what rounding leaves open."""

    value: float
    half_unit: float

    def is_cut_from(self, value: float) -> bool:
        """Whether these are the first digits of a value, with the others left out.

        Examples
        --------
        >>> printed_number("64.93").is_cut_from(64.9351)
        True
        """
        same_sign = math.copysign(1.0, value) == math.copysign(1.0, self.value)
        beyond = abs(value) - abs(self.value)
        return same_sign and 0.0 <= beyond < 2.0 * self.half_unit


def printed_number(text: str, digits: int | None = None) -> PrintedNumber:
    """Read a number as it is printed, so that its digits count.

    Parameters
    ----------
    text : str
        "3.0536", "1.242E-02", "−2.6". Trailing zeros count as digits, also of whole numbers. A
        bare "0" says that there is nothing, and leaves nothing open.
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros: "1" beside "0.92".

    Raises
    ------
    ValueError
        It is no number.

    Examples
    --------
    >>> printed_number("3.0536")
    PrintedNumber(value=3.0536, half_unit=5e-05)
    >>> printed_number("1.24E-02").half_unit
    5e-05
    >>> printed_number("5744").half_unit, printed_number("1", digits=2).half_unit
    (0.5, 0.05)
    """
    match = _NUMBER.fullmatch(text.strip())
    if match is None or not (match[2] or match[3]):
        raise ValueError(f"{text!r} is no printed number")
    plain = text.strip().replace("−", "-")
    power = int((match[4] or "0").replace("−", "-"))
    value, last = float(plain), power - len(match[3])
    if value == 0.0 and not match[3]:
        return PrintedNumber(value, 0.0)
    if digits is not None and value:
        last = math.floor(math.log10(abs(value))) - digits + 1
    # From text, so that 5e-05 is the nearest number to it.
    return PrintedNumber(value, float(f"5e{last - 1}"))


@dataclass(frozen=True)
class Printed:
    """A line of the table of a document.

    Parameters
    ----------
    place : str
        Where it stands in the document: "Table 7", "(100b)", "section 4".
    name : str
        What it is: "IAE of C, constant outflow, by hand". No two of one place have one name.
    text : str
        As printed: a number with all its digits, a formula for SymPy, or words.
    unit : str
    digits : int, optional
        Significant digits, where the print leaves out trailing zeros.
    damage : str
        What in our text of the document looks like damage of its conversion.
    note : str
        What it is compared with and why, where that needs no computation.
    is_given : bool
        Whether the computation starts from it, and nothing judges it.

    Examples
    --------
    >>> Printed("Table 7", "IE of C", "0.380").number
    PrintedNumber(value=0.38, half_unit=0.0005)
    """

    place: str
    name: str
    text: str
    unit: str = ""
    digits: int | None = None
    damage: str = ""
    note: str = ""
    is_given: bool = False

    @property
    def value(self) -> float:
        """The number without what its digits leave open."""
        return self.number.value

    @property
    def number(self) -> PrintedNumber:
        """The text as a number."""
        return printed_number(self.text, self.digits)


PrintedTable = dict[tuple[str, str], Printed]


def values(table: PrintedTable, place: str, *names: str) -> list[float]:
    """Return the numbers of a place by their names.

    Examples
    --------
    >>> values(printed_table("clepsydra.papers.three_tanks"), "Ziegler-Nichols", "Kc", "Kd")
    [0.0012, 0.028]
    """
    return [table[place, name].value for name in names]


def printed_table(package: str) -> PrintedTable:
    """Return ``printed.csv`` of the package of a document by place and name.

    Examples
    --------
    >>> table = printed_table("clepsydra.papers.three_tanks")
    >>> table["Ziegler-Nichols", "Kc"].text
    '0.0012'
    """
    with resources.files(package).joinpath("printed.csv").open(encoding="utf-8") as file:
        lines = [
            Printed(place, name, text, unit, int(digits or 0) or None, damage, note, bool(given))
            for place, name, text, unit, digits, damage, note, given in [*csv.reader(file)][1:]
        ]
    table = {(line.place, line.name): line for line in lines}
    assert len(table) == len(lines), f"printed.csv of {package} has a line of one name twice"
    return table
