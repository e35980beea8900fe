"""The codes by which OPC UA knows units: those of UNECE, Recommendation 20."""

from __future__ import annotations

from typing import NamedTuple

#: Where the codes are from, as OPC 10000-8, 5.6.4.3 wants it.
UNECE = "http://www.opcfoundation.org/UA/units/un/cefact"
_CODES = {
    "%": ("P1", "%", "percent"),
    "m": ("MTR", "m", "metre"),
    "cm": ("CMT", "cm", "centimetre"),
    "mm": ("MMT", "mm", "millimetre"),
    "m^2": ("MTK", "m²", "square metre"),
    "cm^2": ("CMK", "cm²", "square centimetre"),
    "m^3": ("MTQ", "m³", "cubic metre"),
    "cm^3": ("CMQ", "cm³", "cubic centimetre"),
    "l": ("LTR", "l", "litre"),
    "m^3/s": ("MQS", "m³/s", "cubic metre per second"),
    "m^3/min": ("G53", "m³/min", "cubic metre per minute"),
    "m^3/h": ("MQH", "m³/h", "cubic metre per hour"),
    "cm^3/s": ("2J", "cm³/s", "cubic centimetre per second"),
    "l/s": ("G51", "l/s", "litre per second"),
    "l/min": ("L2", "l/min", "litre per minute"),
    "l/h": ("E32", "l/h", "litre per hour"),
    "m/s": ("MTS", "m/s", "metre per second"),
    "V": ("VLT", "V", "volt"),
    "A": ("AMP", "A", "ampere"),
    "mA": ("4K", "mA", "milliampere"),
    "s": ("SEC", "s", "second"),
    "min": ("MIN", "min", "minute"),
    "h": ("HUR", "h", "hour"),
    "kg": ("KGM", "kg", "kilogram"),
    "kg/m^3": ("KMQ", "kg/m³", "kilogram per cubic metre"),
    "g/m^3": ("A93", "g/m³", "gram per cubic metre"),
    "g/l": ("GL", "g/l", "gram per litre"),
    "mol": ("C34", "mol", "mole"),
    "mol/m^3": ("C36", "mol/m³", "mole per cubic metre"),
    "kmol/m^3": ("B46", "kmol/m³", "kilomole per cubic metre"),
}


class EngineeringUnit(NamedTuple):
    """A unit as OPC UA tells it.

    Parameters
    ----------
    code : int
        The letters of its code as one number, −1 for none.
    shown, words : str
    """

    code: int
    shown: str
    words: str


def engineering_unit(unit: str) -> EngineeringUnit:
    """Return how OPC UA tells a unit.

    The number of a code is that of its letters, the first one the most significant
    (OPC 10000-8, 5.6.4.3: "MTR" is 0x4D5452).

    Examples
    --------
    >>> engineering_unit("m")
    EngineeringUnit(code=5067858, shown='m', words='metre')
    >>> engineering_unit("cm^3/(s V)")
    EngineeringUnit(code=-1, shown='cm^3/(s V)', words='')
    >>> engineering_unit("1").shown
    ''
    """
    if unit not in _CODES:
        return EngineeringUnit(-1, "" if unit == "1" else unit, "")
    letters, shown, words = _CODES[unit]
    return EngineeringUnit(int.from_bytes(letters.encode("ascii"), "big"), shown, words)
