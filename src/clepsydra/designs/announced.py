"""What the text of a file announces above its designs: their names, and what studies try of them.

Studies know by it in which order they go on, before any design is imported that comes later.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

_DESIGN = re.compile(r"^@(design\(.*?\))\ndef ", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Studied:
    """A controller by a design that a study of all controllers tries.

    Parameters
    ----------
    place : float
        Studies go from the lowest to the highest.
    name : str
        What the reader sees: "PID, SIMC".
    arguments : mapping
        As in a study file: {"actions": "PID"}.
    """

    place: float
    name: str
    arguments: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Announced:
    """A design before its file is imported: what it is called, and as what studies try it."""

    name: str
    words: str
    studied: tuple[Studied, ...]

    @property
    def place(self) -> tuple[float, str]:
        """Where it stands among the designs: as in a study, what no study tries at the end."""
        return first_place(self.studied), self.name


def first_place(studied: Iterable[Studied]) -> float:
    """Return the first place at which studies try a design; of what none tries the end.

    >>> first_place([Studied(120, "PID, SIMC"), Studied(20, "PI, SIMC")]), first_place([])
    (20, inf)
    """
    return min((each.place for each in studied), default=float("inf"))


def announced_in(text: str) -> Iterator[Announced]:
    """Yield what the text of a file announces by its decorators.

    Examples
    --------
    >>> text = '@design("lag", "PI for a lag", Studied(25, "PI, lag"))\\ndef design_lag(model): ...'
    >>> next(announced_in(text)).studied
    (Studied(place=25, name='PI, lag', arguments={}),)
    """
    for decorator in _DESIGN.findall(text):
        call = ast.parse(decorator, mode="eval").body
        assert isinstance(call, ast.Call)
        name, words, *studied = (_value(each, text) for each in call.args)
        yield Announced(name, words, tuple(studied))


def _value(node: ast.expr, text: str) -> Any:
    """Return what is written: a literal, a `Studied` of such, or a constant of the file."""
    if isinstance(node, ast.Call):
        return Studied(*(_value(each, text) for each in node.args))
    if isinstance(node, ast.Name):
        constant = re.search(rf"^{node.id} = (.+)$", text, re.MULTILINE)
        node = ast.parse(constant[1] if constant else node.id, mode="eval").body
    return ast.literal_eval(node)
