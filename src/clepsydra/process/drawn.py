"""Plants of one kind: a process whose holes, splits and gains are drawn from a number."""

from __future__ import annotations

import re
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.engine.philox import WORD, philox
from clepsydra.process.process import Process

#: How far a drawn parameter may lie from that of the file, as a share of it.
SPREAD = 0.1
#: Of the last word of a counter, beside those of noise.
_DRAWS = 2
_NUMBERED = re.compile(r"(.+)#(\d{1,20})")


def split_number(text: str) -> tuple[str, int]:
    """Split "process#7" into what it is drawn from and its number, 0 where it has none.

    Raises
    ------
    InputError
        The number is too large.

    Examples
    --------
    >>> split_number("quadruple-tank#7"), split_number("laboratory-four-tanks:fitted,volts")
    (('quadruple-tank', 7), ('laboratory-four-tanks:fitted,volts', 0))
    """
    match = _NUMBERED.fullmatch(text)
    if match is None:
        return text, 0
    number = int(match[2])
    check_number(number, f"process, {text[:60]}")
    return match[1], number


def numbered(address: str, number: int) -> str:
    """Return what a user types for something as a number draws it.

    Raises
    ------
    InputError
        Nothing is drawn from such a number.
    """
    check_number(number, "variant")
    return f"{address}#{number}" if number else address


def check_number(number: int, place: str) -> None:
    """Raise an InputError unless plants are drawn from a number; 0 is as the file has it.

    Examples
    --------
    >>> check_number(-3, "--variant")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: --variant: got -3, expected a whole number from 0 to \
4294967295; 0 is the process as its file has it.
    """
    if not 0 <= number <= WORD:
        expected = f"a whole number from 0 to {WORD}"
        raise InputError(place, number, expected, "0 is the process as its file has it")


def drawn(process: Process, number: int) -> Process:
    """Return a process whose holes, splits and gains are those of a number; itself for 0.

    Each lies within 10 % of its value in the file, uniformly, and follows from the number and
    its name alone: integers decide, so it is the same on every machine, and what two processes
    call by one name is as much larger or smaller in both.

    Raises
    ------
    InputError
        The process has none of these.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> other = load_process("quadruple-tank#7")
    >>> round(other.signal("outlet_1.area").initial / 0.071e-4, 4), other.address
    (0.9839, 'quadruple-tank#7')
    """
    if not number:
        return process
    names = {name for element in process.elements for name in element.as_built()}
    if not names:
        raise InputError(
            "variant", number, f"0 for {process.name}, which has no hole, split or gain to draw",
            "leave it out",
        )  # fmt: skip
    parameters = tuple(
        replace(each, initial=min(each.initial * _factor(number, each.name), each.high))
        if each.name in names
        else each
        for each in process.parameters
    )
    return replace(process, parameters=parameters, drawn=number)


def _factor(number: int, name: str) -> float:
    """Return what a parameter is multiplied by, from 0.9 to 1.1."""
    # Where numbers are drawn alone: every process is read by a module that reads this one.
    from clepsydra.engine.white_noise import stream_of

    word, *_ = philox((stream_of(name), 0, 0, _DRAWS), (number, 0))
    return 1.0 + SPREAD * (2.0 * (int(word) / WORD) - 1.0)
