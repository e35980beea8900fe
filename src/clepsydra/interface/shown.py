"""Results that answer when they are printed."""

from __future__ import annotations

import io
import re
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, TypeVar

from clepsydra.base.errors import UnknownName
from clepsydra.base.section import Line, Mark, Picture, Section, Table

if TYPE_CHECKING:
    from rich.console import RenderableType

_WIDTH = 100
#: What an option of the command line is called as an argument of `shown`.
_OPTIONS = {"--all": "every", "--why": "why", "--refused": "refused"}
_OPTION = re.compile(rf"(?:{'|'.join(_OPTIONS)})\b")


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


class Page(Shown):
    """An answer: printed in Python, and `on_command_line` with the commands that follow.

    Parameters
    ----------
    section : Section
        In the words of the command line.
    """

    def __init__(self, section: Section) -> None:
        self.section = section

    @property
    def on_command_line(self) -> RenderableType:
        """What a terminal shows of it."""
        return screen(self.section)

    def __rich__(self) -> RenderableType:
        """Return what a prompt of Python shows."""
        return screen(in_python(self.section))

    def _repr_markdown_(self) -> str:
        """Return what a notebook shows."""
        from clepsydra.base.markdown import markdown

        return markdown(in_python(self.section))


class Answered(Shown):
    """What answers in sections: in text, in colour, and as Markdown in a notebook."""

    def answer(self) -> Section:
        """Return what it says."""
        raise NotImplementedError

    def shown(self, **more: bool) -> Page:
        """Return the answer to print, with what `answer` is asked for beside it."""
        return Page(self.answer(**more))

    def __rich__(self) -> RenderableType:
        """Return what a prompt of Python shows."""
        return self.shown().__rich__()

    def _repr_markdown_(self) -> str:
        """Return what a notebook shows."""
        return self.shown()._repr_markdown_()


def in_python(section: Section) -> Section:
    """Return an answer with calls for options, and without what follows on the command line.

    Examples
    --------
    >>> said = Line("why this order: --why"), Line("Next: clepsydra verify", Mark.COMMAND)
    >>> in_python(Section("", said)).parts[0].text
    'why this order: shown(why=True)'
    """
    parts: list[Line | Table | Picture | Section] = []
    for part in section.parts:
        if isinstance(part, Section):
            parts.append(in_python(part))
        elif not isinstance(part, Line):
            parts.append(part)
        elif part.mark not in (Mark.COMMAND, Mark.NEXT):
            text, narrow = (_OPTION.sub(_call, words) for words in (part.text, part.narrow))
            parts.append(replace(part, text=text, narrow=narrow))
    while parts and parts[-1] == Line(""):
        parts.pop()
    return replace(section, parts=tuple(parts))


def _call(option: re.Match[str]) -> str:
    return f"shown({_OPTIONS[option[0]]}=True)"


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
