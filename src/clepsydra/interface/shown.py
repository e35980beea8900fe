"""Results that answer when they are printed."""

from __future__ import annotations

import io
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

from clepsydra.base.errors import UnknownName

if TYPE_CHECKING:
    from rich.console import RenderableType

    from clepsydra.base.section import Section

_WIDTH = 100


class Told:
    """What answers to an unknown name with the nearest that there is."""

    def _remedy(self, name: str) -> str:
        """Return what to do about a name that is like none of its own; empty for the usual."""
        return ""

    if not TYPE_CHECKING:  # where a type checker would take any name for known

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or hasattr(type(self), name):  # Python's own error, or ours
                return object.__getattribute__(self, name)
            kind, names = type(self), [each for each in dir(self) if not each.startswith("_")]
            raise UnknownName(kind.__name__, name, names, self._remedy(name))


class Shown(Told):
    """What prints itself as the command line shows it, in text and, by Rich, in colour."""

    def __rich__(self) -> RenderableType:
        """Return what a terminal shows."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """Return it as text of at most 100 columns."""
        from rich.console import Console

        console = Console(width=_WIDTH, file=io.StringIO(), color_system=None, record=True)
        console.print(self.__rich__(), crop=False)
        lines = console.export_text().splitlines()
        return "\n".join(line.rstrip() for line in lines).strip("\n")

    def __str__(self) -> str:
        """Return the same."""
        return repr(self)


def screen(section: Section) -> RenderableType:
    """Return sections for a terminal."""
    from clepsydra.report.screen import Screen

    return Screen(section)


class Answered(Shown):
    """What answers in sections: in text, in colour, and as Markdown in a notebook."""

    def answer(self) -> Section:
        """Return what it says."""
        raise NotImplementedError

    def shown(self, **more: bool) -> RenderableType:
        """Return the answer for a terminal, with what `answer` is asked for beside it."""
        return screen(self.answer(**more))

    def __rich__(self) -> RenderableType:
        """Return what a terminal shows."""
        return self.shown()

    def _repr_markdown_(self) -> str:
        """Return what a notebook shows."""
        from clepsydra.base.markdown import markdown

        return markdown(self.answer())


_Kind = TypeVar("_Kind")


def lifted(kind: type[_Kind], inner: Any, **more: Any) -> _Kind:
    """Return a result of an inner package as one of the interface, which inherits from its class.

    Parameters
    ----------
    kind : type
        A subclass of the inner dataclass.
    inner : object
    **more
        Fields that the subclass adds, or in the place of the inner ones.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> class Titled(Signal):
    ...     title = "A level"
    >>> lifted(Titled, Signal("level", "m")).unit
    'm'
    """
    own = [each.name for each in fields(kind) if each.name not in more]  # type: ignore[arg-type]
    given = {name: getattr(inner, name) for name in own if hasattr(inner, name)}
    return kind(**{**given, **more})
