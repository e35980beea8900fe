"""The order in which the parts of a scheme compute: what gives a value before what takes it."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from clepsydra.base.errors import InputError


def in_order(place: str, sources: Mapping[str, Collection[str]]) -> list[str]:
    """Return names so that each stands after all that it takes a value from.

    Parameters
    ----------
    place : str
        For the message.
    sources : mapping
        Name to those that it takes a value from.

    Raises InputError: some take their values from each other in a circle; the first of them ends
    the place.

    Examples
    --------
    >>> in_order("scheme", {"pump": ["level"], "level": []})
    ['level', 'pump']
    """
    ordered: list[str] = []
    while len(ordered) < len(sources):
        waiting = [name for name in sources if name not in ordered]
        ready = [name for name in waiting if set(sources[name]) <= set(ordered)]
        if not ready:
            circle = _circle(waiting, sources)
            raise InputError(
                f"{place}, {circle[0]}",
                " → ".join([*circle, circle[0]]),
                "a way from setpoints to manipulated variables without a circle",
                "let one of them move something else, or take its value from elsewhere",
            )
        ordered += ready
    return ordered


def _circle(waiting: list[str], sources: Mapping[str, Collection[str]]) -> list[str]:
    """Return names of which each gives its value to the next, and the last to the first."""
    passed = [waiting[0]]
    while True:
        source = next(name for name in sources[passed[-1]] if name in waiting)
        if source in passed:
            circle = passed[passed.index(source) :][::-1]
            first = circle.index(min(circle, key=waiting.index))
            return circle[first:] + circle[:first]
        passed.append(source)
