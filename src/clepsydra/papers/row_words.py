"""The cells of a row as a reader sees them."""

from __future__ import annotations

from clepsydra.papers.row import Row
from clepsydra.report.quantities import number_text


def printed_words(row: Row) -> str:
    """Return what is printed, with all its digits.

    Examples
    --------
    >>> printed_words(Row("Table 7", "IE", 0.38, 0.3799, "", None, "reproduced", "", text="0.380"))
    '0.380'
    """
    return row.text or value_words(row.printed)


def value_words(value: float | str) -> str:
    """Return a printed or computed value in at most six digits; words stay as they are.

    Examples
    --------
    >>> value_words(-8.5), value_words(0.0012345678), value_words("no overshoot")
    ('−8.5', '0.00123457', 'no overshoot')
    """
    return value if isinstance(value, str) else f"{value:.6g}".replace("-", "−")


def difference_words(difference: float | None) -> str:
    """Return a relative difference in percent, or how many times the print it is.

    Examples
    --------
    >>> difference_words(0.03561), difference_words(-2e-7), difference_words(None)
    ('+3.6 %', '0 %', '')
    >>> difference_words(99.0), difference_words(-5406.0)
    ('100 ×', '−5400 ×')
    """
    if difference is None:
        return ""
    if abs(difference) >= 10.0:
        times = difference + 1.0
        return f"{float(f'{times:.2g}'):g} ×".replace("-", "−")
    percent = 100.0 * difference
    if abs(percent) < 5e-4:
        return "0 %"
    sign = "+" if percent > 0 else "−"
    return f"{sign}{number_text(abs(percent), 2)} %"
