"""The packages that doors serve with, which the extra `plant` brings."""

from __future__ import annotations

from importlib.util import find_spec

from clepsydra.base.errors import Finding, InputError


def require_packages(place: str, *packages: str) -> None:
    """Refuse what needs a package that is not installed.

    Parameters
    ----------
    place : str
        Who needs it, for the message.

    Examples
    --------
    >>> require_packages("a door", "no_such_package")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: a door: got no no_such_package, expected it to be \
installed; pip install 'clepsydra[plant]'.
    """
    for package in packages:
        if find_spec(package) is None:
            raise InputError(
                place, Finding(f"no {package}"), "it to be installed",
                "pip install 'clepsydra[plant]'",
            )  # fmt: skip
