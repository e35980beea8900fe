"""What a design is called and what it is: declared above the function that designs."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

from clepsydra.base.registry import AnnouncedRegistry
from clepsydra.designs.announced import Announced, announced_in, first_place
from clepsydra.designs.announced import Studied as Studied
from clepsydra.designs.applicability import told_by
from clepsydra.designs.arguments.argument import Argument, of_key

if TYPE_CHECKING:
    from clepsydra.base.key import Key
    from clepsydra.controllers.controller import Controller

F = TypeVar("F", bound="Callable[..., Controller]")


@dataclass(frozen=True)
class Design:
    """A design method: a linear model and some arguments to a controller.

    Parameters
    ----------
    name : str
        What study files and `clepsydra.design` call it.
    words : str
        What it is, in a few words.
    function : callable
        It takes a model first, and a pairing second if it has one; each keyword is a key of the
        study file.
    studied : tuple of Studied
        As what a study of all controllers tries it.
    keys : tuple of Argument
        Its arguments, as study files, calls and editors take them. Pairing and form are the same
        of every design, and need no mention; what only a program can give, a controller or a
        sampled model, is not among them.
    """

    name: str
    words: str
    function: Callable[..., Controller]
    studied: tuple[Studied, ...] = ()
    keys: tuple[Argument, ...] = ()

    @property
    def declared(self) -> dict[str, Argument]:
        """What it takes besides the model, by name, in the order of the function.

        >>> list(DESIGNS["arrest_time"].declared)
        ['pairing', 'form', 'arrest_time', 'deviation', 'damping']
        """
        from clepsydra.designs.arguments.of_process import PAIRING  # with all that reads a table
        from clepsydra.designs.arguments.pid_form import FORM

        known = {each.name: each for each in (PAIRING, FORM, *self.keys)}
        return {name: known[name] for name in self.arguments if name in known}

    @property
    def file_keys(self) -> tuple[str, ...]:
        """Its keys in a study file, where a form of PID controller stands by keys of its own.

        >>> DESIGNS["amigo"].file_keys
        ('pairing', 'actions', 'algorithm', 'derivative_on', 'anti_windup', 'as_published')
        """
        return tuple(key for each in self.declared.values() for key in each.keys)

    @property
    def arguments(self) -> tuple[str, ...]:
        """The names of what it takes besides the model."""
        return tuple(inspect.signature(self.function).parameters)[1:]

    @property
    def required(self) -> tuple[str, ...]:
        """Those without a default, but for the pairing, which the analysis suggests.

        >>> DESIGNS["lqi_by_weights"].required
        ('weights',)
        """
        parameters = inspect.signature(self.function).parameters
        return tuple(
            name
            for name in self.arguments
            if parameters[name].default is inspect.Parameter.empty and name != "pairing"
        )

    @property
    def place(self) -> tuple[float, str]:
        """Where it stands among the designs: as in a study, what no study tries at the end."""
        return first_place(self.studied), self.name


DESIGNS: AnnouncedRegistry[Design, Announced] = AnnouncedRegistry(
    "clepsydra.designs",
    order=lambda each: each.place,
    announced=lambda text: {each.name: each for each in announced_in(text)},
)


def design(
    name: str,
    words: str,
    *studied: Studied,
    keys: tuple[Key | Argument, ...] = (),
    method: str = "",
) -> Callable[[F], F]:
    """Return a decorator that registers a function as a design; all as in `Design`.

    Name, words and what is studied are literals, or constants of the file: they are read in its
    text. What it refuses says the method, the words if none is given. A key among `keys` is a
    quantity above its low bound. Before the function is called its arguments are checked as
    declared.

    The function takes the linear model of a process at an operating point. Its docstring leaves out
    what designs share: `pairing`, which the relative gains suggest where none is given, and `form`,
    PI in ISA form where none is given; `interface.lift` tells of them.

    Examples
    --------
    >>> DESIGNS["simc"].words, [each.name for each in DESIGNS["simc"].studied][:2]
    ('PI or PID by SIMC', ['PI, SIMC', 'PI, SIMC, static decoupling'])
    """

    declared = tuple(each if isinstance(each, Argument) else of_key(each) for each in keys)

    def register(function: F) -> F:
        signature = inspect.signature(function)

        @wraps(function)
        def designed(*args: Any, **kwargs: Any) -> Controller:
            given = signature.bind(*args, **kwargs).arguments
            with told_by(method or words):
                for each in declared:
                    if given.get(each.name) is not None:
                        each.check(given[each.name])
                return function(*args, **kwargs)

        DESIGNS.add(name, Design(name, words, designed, studied, declared), function.__module__)
        return cast(F, designed)

    return register
