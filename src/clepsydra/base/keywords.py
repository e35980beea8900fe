"""Keywords of a public function that it does not take."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection, Iterable
from typing import ParamSpec, TypeVar

from clepsydra.base.errors import UnknownArgument

P = ParamSpec("P")
T = TypeVar("T")

_REMEDY = "choose one of them"


def check_keywords(
    place: str, given: Iterable[str], known: Collection[str], remedy: str = _REMEDY
) -> None:
    """Refuse the keywords of a call that it does not take.

    Examples
    --------
    >>> check_keywords("simc", ["tau_c"], ["pairing", "closed_loop_time_constant"])
    Traceback (most recent call last):
    clepsydra.base.errors.UnknownArgument: simc: got 'tau_c', expected one of pairing, \
closed_loop_time_constant; perhaps 'closed_loop_time_constant' was meant.
    """
    for name in given:
        if name not in known:
            raise UnknownArgument(place, name, known, remedy)


def keywords_checked(remedy: str = _REMEDY) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Return a decorator after which a function refuses the keywords that it does not take.

    Parameters
    ----------
    remedy : str
        What to do where no argument is spelt alike.

    Examples
    --------
    >>> @keywords_checked("write as in with_values({'level_1': {'K': 6.0}})")
    ... def with_values(values):
    ...     return values
    >>> with_values(K=6.0)
    Traceback (most recent call last):
    clepsydra.base.errors.UnknownArgument: with_values: got 'K', expected one of values; \
write as in with_values({'level_1': {'K': 6.0}}).
    """

    def decorated(function: Callable[P, T]) -> Callable[P, T]:
        known = [name for name in inspect.signature(function).parameters if name != "self"]

        @functools.wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> T:
            check_keywords(function.__qualname__, kwargs, known, remedy)
            return function(*args, **kwargs)

        return checked

    return decorated
