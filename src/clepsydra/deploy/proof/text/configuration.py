"""The CONFIGURATION of Structured Text: which program runs how often."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING

from clepsydra.deploy.proof.text.tree import content, part, walk, wrong

if TYPE_CHECKING:
    from tree_sitter import Node

_UNITS = {"d": 86_400_000, "h": 3_600_000, "m": 60_000, "s": 1000, "ms": 1}


@dataclass(frozen=True)
class Task:
    """A program and the interval at which it runs.

    Parameters
    ----------
    program : str
        Its type.
    interval : float
        [s]

    Examples
    --------
    >>> Task("tank_test", 0.1).interval
    0.1
    """

    program: str
    interval: float


def tasks_of(root: Node) -> tuple[Task, ...]:
    """Return the programs that the configurations of a text run.

    Raises
    ------
    StructuredTextError
        A program runs in a task that is not declared or has no interval.

    Examples
    --------
    >>> from clepsydra.deploy.proof.text.tree import parse
    >>> tasks_of(parse('''CONFIGURATION plant RESOURCE processor ON PLC
    ... TASK scan(INTERVAL := T#1s500ms, PRIORITY := 1);
    ... PROGRAM test WITH scan : tank_test;
    ... END_RESOURCE END_CONFIGURATION'''))
    (Task(program='tank_test', interval=1.5),)
    """
    nodes = list(walk(root))
    intervals: dict[str, float] = {}
    for node in nodes:
        if node.type == "task_declaration":
            given = {
                content(part(parameter, "name")).upper(): part(parameter, "value")
                for parameter in node.named_children
                if parameter.type == "task_parameter"
            }
            if "INTERVAL" in given:
                intervals[content(part(node, "name")).lower()] = duration(given["INTERVAL"])
    found = []
    for node in nodes:
        if node.type == "program_assignment":
            task = content(part(node, "task")).lower()
            if task not in intervals:
                raise wrong(node, f"{task} is no task with an interval")
            found.append(Task(content(part(node, "program_type")), intervals[task]))
    return tuple(found)


def duration(node: Node) -> float:
    """Return a literal of TIME in seconds.

    Examples
    --------
    >>> from clepsydra.deploy.proof.text.tree import parse, walk
    >>> root = parse("PROGRAM p VAR t : TIME := T#1.5s; END_VAR END_PROGRAM")
    >>> duration(next(node for node in walk(root) if node.type == "time_literal"))
    1.5
    """
    _, _, text = content(node).lower().replace("_", "").partition("#")
    parts = re.findall(r"([\d.]+)(ms|[dhms])", text)
    if "".join(number + unit for number, unit in parts) != text or not parts:
        raise wrong(node, f"{content(node)} is no TIME known here")
    return float(sum(Decimal(number) * _UNITS[unit] for number, unit in parts) / 1000)
