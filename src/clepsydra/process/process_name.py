"""The name of a process: what its files are called."""

from __future__ import annotations

import re

from clepsydra.base.errors import InputError

_NAME = re.compile(r"[A-Za-z](?:[-_]?[A-Za-z0-9]){0,59}")


def check_process_name(name: str, place: str) -> None:
    """Refuse a name that could not be the name of a file everywhere.

    Parameters
    ----------
    place : str
        Where it was given.

    Examples
    --------
    >>> check_process_name("my tanks", "plant.toml, line 1, name")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: plant.toml, line 1, name: got 'my tanks', expected letters, \
digits and single hyphens after a first letter; write as in name = "my-tanks", and put words for \
people into title.
    """
    if _NAME.fullmatch(name):
        return
    remedy = 'write as in name = "my-tanks"'
    written = "-".join(re.findall(r"[A-Za-z0-9]+", name))
    if " " in name and _NAME.fullmatch(written):
        remedy = f'write as in name = "{written}", and put words for people into title'
    expected = "letters, digits and single hyphens after a first letter"
    raise InputError(place, name if len(name) <= 60 else f"{name[:57]}...", expected, remedy)
