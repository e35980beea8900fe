"""What a user is told when an input cannot be used."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from clepsydra.base.suggestion import suggestion


class ClepsydraError(Exception):
    """The root of every error that Clepsydra raises on purpose.

    The command line prints it as one message and ends with exit status 2.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> try:
    ...     load_process("no-such-tank.toml")
    ... except ClepsydraError as error:
    ...     print(error)
    no-such-tank.toml: got no such file, expected a process file; check the path.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        """Return it with its fields: a worker's mistake is told where it was asked to work."""
        return _made_again, (type(self), self.args), vars(self)


def _made_again(kind: type[ClepsydraError], arguments: tuple[object, ...]) -> ClepsydraError:
    """Return an error with its message, without asking for what the message was made of."""
    return kind.__new__(kind, *arguments)


class Finding(str):
    """What was found in the place of a value, in words: a message has it without quotation marks.

    Examples
    --------
    >>> print(InputError("plant.toml, line 3", Finding("no area"), "an area", "give one"))
    plant.toml, line 3: got no area, expected an area; give one.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


class InputError(ClepsydraError):
    """An input that cannot be used: where it stands, what it is, what was expected, what to do.

    Parameters
    ----------
    place : str
        File and line ("plant.toml, line 12") or path in the model ("tanks.tank_1.area").
    value : object
        The offending value as the user wrote it, or a `Finding`.
    expected : str
        What was expected, with its unit.
    remedy : str
        What to do about it.

    Examples
    --------
    >>> print(InputError("plant.toml, line 3, tanks.a.area", "-1 cm^2",
    ...                  "an area above 0 cm^2", "give the cross-section of the tank"))
    plant.toml, line 3, tanks.a.area: got '-1 cm^2', expected an area above 0 cm^2; \
give the cross-section of the tank.
    """

    def __init__(self, place: str, value: object, expected: str, remedy: str) -> None:
        self.place = place
        self.value = value
        self.expected = expected
        self.remedy = remedy
        super().__init__(f"{place}: got {value!r}, expected {expected}; {remedy}.")


class UnknownName(InputError, AttributeError):
    """A name that a part of the public interface does not have.

    Parameters
    ----------
    owner : str
        What was asked for it.
    known : iterable of str
        The names that there are.
    remedy : str
        What to do where none of them is close; to choose one if left out.

    Examples
    --------
    >>> print(UnknownName("cl.design", "smic", ["lqi", "simc"]))
    cl.design: got 'smic', expected one of lqi, simc; perhaps 'simc' was meant.
    """

    def __init__(self, owner: str, name: str, known: Iterable[str], remedy: str = "") -> None:
        names = sorted(known)
        remedy = suggestion(name, names, remedy or f"choose one of them; dir({owner}) lists them")
        super().__init__(owner, name, f"one of {', '.join(names)}", remedy)


class UnknownKey(InputError, KeyError):
    """A key that a mapping of the public interface does not have; all as for `InputError`."""

    def __str__(self) -> str:  # that of a KeyError would be in quotation marks
        return str(self.args[0])


class UnknownArgument(InputError, TypeError):
    """A keyword that a call of the public interface does not take.

    Parameters
    ----------
    place : str
        What was called.
    known : iterable of str
        The arguments that it takes.
    remedy : str
        What to do where none of them is close.
    """

    def __init__(self, place: str, name: str, known: Iterable[str], remedy: str) -> None:
        names = list(known)
        expected = f"one of {', '.join(names)}" if names else "no keyword"
        super().__init__(place, name, expected, suggestion(name, names, remedy))


def reason_of(error: OSError | ValueError) -> str:
    """Return why a file cannot be used, in the same words in every version of Python."""
    if isinstance(error, ValueError):  # what `open` raises for it, each version in words of its own
        return "a null character in its name"
    return (error.strerror or str(error)).lower()
