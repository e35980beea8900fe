"""What a verb of the command line is: declared above the function that does it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from clepsydra.base.registry import Registry

F = TypeVar("F", bound=Callable[..., None])


@dataclass(frozen=True)
class Verb:
    """A verb: its place among the others and what it does.

    Parameters
    ----------
    place : float
        The help goes from the lowest to the highest: what a newcomer does first comes first.
    function : callable
        Its parameters are the verb's arguments and options, its docstring is the help.
    """

    place: float
    function: Callable[..., None]


VERBS: Registry[Verb] = Registry("clepsydra.cli", order=lambda verb: verb.place)


def verb(place: float) -> Callable[[F], F]:
    """Return a decorator that registers a function as a verb, at_rest as at-rest; as in `Verb`.

    Its file imports what is numeric inside the function, so that the help is immediate.

    Examples
    --------
    >>> list(VERBS)[:3]
    ['study', 'simulate', 'analyse']
    """

    def register(function: F) -> F:
        VERBS.add(function.__name__.replace("_", "-"), Verb(place, function))
        return function

    return register
