"""A hint at the name that was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def suggestion(wrong: object, known: Iterable[str], otherwise: str) -> str:
    """Return "perhaps … was meant" where a known name is close, else what to do instead.

    It is the remedy of an `InputError` about a name.

    Parameters
    ----------
    wrong : object
        What was given as a name.
    known : iterable of str
        The names that there are.
    otherwise : str
        What to do where none of them is close.

    Examples
    --------
    >>> suggestion("tnak_1", ["tank_1", "basin"], "choose one")
    "perhaps 'tank_1' was meant"
    >>> suggestion("pi, simc", ["PI, arrest time", "PI, SIMC"], "choose one")
    "perhaps 'PI, SIMC' was meant"
    >>> suggestion("pump", ["tank_1", "basin"], "choose one")
    'choose one'
    """
    spelt = {name.lower(): name for name in known}
    close = difflib.get_close_matches(str(wrong)[:80].lower(), spelt, n=1)
    return f"perhaps '{spelt[close[0]]}' was meant" if close else otherwise
