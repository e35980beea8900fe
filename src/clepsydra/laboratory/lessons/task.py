"""A task of a lesson: where the rig begins, what to reach, and what to find."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from clepsydra.base.arguments import require_known
from clepsydra.base.signal import Signal
from clepsydra.laboratory.lessons.figure import Figure, read_figures
from clepsydra.laboratory.lessons.reach import Reach, controller_field, read_reach
from clepsydra.laboratory.lessons.told_text import line, paragraphs, texts
from clepsydra.process import told
from clepsydra.process.declared import choice, flag, keys_of, part, read_fields, table_schema
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader

#: Where the rig begins; "stands": where it is.
Begin = Literal["stands", "rest", "empty"]
#: How a controller begins: without a bump, or with states that are zero, as the law declares them.
ControllerStart = Literal["bumpless", "zero"]


def _setup(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
    """Return the name of a set-up of the lesson; empty for the rig as it is."""
    if not table.has(key):
        return ""
    names = [each for each in known["processes"] if each]
    name = table.text(key, "the name of a set-up", "leave it out for the rig as it is")
    require_known(table.place(key), name, names, "a set-up of this lesson")
    return name


def _values(words: str, signals: Callable[[Mapping[str, Any]], Sequence[Signal]]) -> Any:
    """Return the field of values of some signals by name [SI]."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, float]:
        if not table.has(key):
            return {}
        own = {each.name: each for each in signals(known)}
        first = next(iter(own), "pump_1")
        rows = table.table(key, words, f'write as in {key} = {{ "{first}" = "1 %" }}')
        for name in rows.present:
            require_known(rows.place(name), name, list(own), words)
        return {
            name: read_value(rows, name, own[name], "a value of", "give it with its unit")
            for name in rows.present
        }

    return part(read, **told.by_name(words))


def _inputs(known: Mapping[str, Any]) -> Sequence[Signal]:
    return _process(known).inputs


def _controlled(known: Mapping[str, Any]) -> Sequence[Signal]:
    process = _process(known)
    return [process.signal(name) for name in process.controlled]


def _settings(known: Mapping[str, Any]) -> Sequence[Signal]:
    """Return the parameters of the law of the controller that has the rig."""
    laws = {each.name: each.law for each in known["controllers"]}
    return laws[known["controller"]].parameters if known["controller"] else ()


def _process(known: Mapping[str, Any]) -> Process:
    process: Process = known["processes"][known["setup"]]
    return process


def _of_setup(read: Any) -> Any:
    """Return what reads rows that are about the process of the set-up that was read before."""

    def found(table: TableReader, key: str, known: Mapping[str, Any]) -> Any:
        steps = len(known.get("reach", ()))
        controllers = known["controllers"]
        return read(table, process=_process(known), steps=steps, controllers=controllers)

    return found


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a reader is asked to do.

    Parameters
    ----------
    title : str
    text : tuple of str
        Paragraphs.
    setup : str
        Of the lesson; empty for the rig as it is.
    start : {"stands", "rest", "empty"}
    controller : str
        Who has the rig when the task begins; empty for whoever has it.
    controller_start : {"bumpless", "zero"}
    settings : mapping
        Parameter of that controller's law to its value when the task begins [SI].
    setpoints : mapping
        Controlled measurement to where its setpoint stands when the task begins [SI].
    manual : mapping
        Input to where it stands by hand when the task begins [SI].
    noise : bool
    reach : tuple of Reach
        Steps, of which each is looked for when the one before is reached.
    figures : tuple of Figure
    hints : tuple of str
        Hidden until asked for.
    solution : tuple of str
        Paragraphs for the lecturer.
    """

    title: str = line("what it is called")
    text: tuple[str, ...] = paragraphs("what is to be done; an empty line ends a paragraph")
    setup: str = part(_setup, **told.text("the set-up that the rig has; as it is if left out"))
    start: Begin = choice(get_args(Begin), words="where the rig begins")
    controller: str = controller_field("who has the rig when it begins")
    controller_start: ControllerStart = choice(
        get_args(ControllerStart), words="how that controller begins"
    )
    settings: dict[str, float] = _values("settings of that controller", _settings)
    setpoints: dict[str, float] = _values("setpoints that it begins with", _controlled)
    manual: dict[str, float] = _values("inputs that begin by hand", _inputs)
    noise: bool = flag(default=False, words="whether it is noisy")
    reach: tuple[Reach, ...] = part(
        _of_setup(read_reach), **told.listed("steps in their order", table_schema(Reach))
    )
    figures: tuple[Figure, ...] = part(
        _of_setup(read_figures), **told.listed("numbers to find", table_schema(Figure))
    )
    hints: tuple[str, ...] = texts("what helps, hidden until asked for")
    solution: tuple[str, ...] = paragraphs("for the lecturer")


def read_tasks(table: TableReader, key: str, **known: Any) -> tuple[Task, ...]:
    """Read the tasks of a lesson in their order.

    Raises
    ------
    InputError
        There is none, or something in one is wrong.
    """
    rows = table.tables(key, "tasks, a table each", "write [[tasks]]", keys_of(Task))
    if not rows:
        raise table.wrong(key, "at least one task", "write [[tasks]]")
    return tuple(Task(**read_fields(Task, row, **known)) for row in rows)
