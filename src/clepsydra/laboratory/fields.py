"""Objects of a session's JSON, read field by field."""

from __future__ import annotations

from typing import Any

from clepsydra.base.errors import Finding, InputError

#: What the file is, for a message, and what to do about one that is damaged.
WHAT = "a session that a laboratory saved"
AGAIN = "save it once more from the laboratory"


class Fields:
    """An object of JSON whose fields are taken one by one.

    Parameters
    ----------
    found : object
        What JSON gave.
    place : str
        What messages call it.

    Raises
    ------
    InputError
        It is no object.

    Examples
    --------
    >>> Fields({"samples": 20}, "session.json").take("samples", int, "how many samples it has")
    20
    """

    def __init__(self, found: Any, place: str) -> None:
        if not isinstance(found, dict):
            raise InputError(place, Finding("no object"), WHAT, AGAIN)
        self.found, self.place = found, place

    def take(self, name: str, kind: type, words: str) -> Any:
        """Return a field of a type; refuse one that is missing or of another."""
        where = f"{self.place}, {name}"
        if name not in self.found:
            raise InputError(where, Finding("nothing"), words, AGAIN)
        value = self.found[name]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise InputError(where, value, words, AGAIN)
        return value
