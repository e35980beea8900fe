"""A lesson: a rig, the controllers that it has, and what its reader is asked to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.laboratory.hands import with_hands
from clepsydra.laboratory.lessons.set_up import (
    SetUp,
    controllers_field,
    process_field,
    read_set_ups,
)
from clepsydra.laboratory.lessons.task import Task, read_tasks
from clepsydra.laboratory.lessons.told_text import line, paragraphs
from clepsydra.laboratory.rig import Numbers, Rig
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.process import told
from clepsydra.process.declared import OWN, keys_of, part, read_fields, table_schema
from clepsydra.process.document import kind_of, parse
from clepsydra.process.drawn import numbered, split_number
from clepsydra.process.elements.transport_delay import TransportDelay
from clepsydra.process.known_names import known_names
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader

#: The folder of those that come with Clepsydra.
_FOLDER = "clepsydra.laboratory.lessons.shipped"


def _setups(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, SetUp]:
    found = read_set_ups(table, key, known["process"], known["folder"], known["variant"])
    names = [each.name for each in _controllers(known["controllers"], found)]
    for name in names:
        if names.count(name) > 1:
            raise table.refused(key, name, "names of which each is one controller's", "rename one")
    if not names:
        remedy = 'write [controllers."PI"], with design = "simc"'
        raise table.wrong("controllers", "at least one controller", remedy)
    return found


def _tasks(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[Task, ...]:
    setups: dict[str, SetUp] = known["setups"]
    every = {"": known["process"], **{name: each.process for name, each in setups.items()}}
    processes = {name: _handled(process) for name, process in every.items()}
    controllers = _controllers(known["controllers"], setups)
    return read_tasks(table, key, processes=processes, controllers=controllers)


def _handled(process: Process) -> Process:
    """Return a process with what hands can do to it."""
    return operating_point_of(with_hands(linearise(find_equilibrium(process)))).process


def _hides(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the numbers of the plant that the reader is to find and not to read."""
    if not table.has(key):
        return ()
    process: Process = known["process"]
    pipes = [each for each in process.elements if isinstance(each, TransportDelay)]
    names = [*(each.name for each in process.parameters), *(f"{each.name}.time" for each in pipes)]
    return known_names(names, table, key, expected="a list of parameters", each="a parameter")


def _controllers(
    own: tuple[Controller, ...], setups: Mapping[str, SetUp]
) -> tuple[Controller, ...]:
    return (*own, *(each for setup in setups.values() for each in setup.controllers))


@dataclass(frozen=True, eq=False, kw_only=True)
class Lesson:
    """A lesson as its file has it.

    Parameters
    ----------
    title : str
    text : tuple of str
        Paragraphs before the first task.
    process : Process
        The rig as it is, drawn by the variant.
    controllers : tuple of Controller
        Designed for it.
    hides : tuple of str
        Parameters, and times of delays, that the page does not show.
    setups : mapping
        Other ways in which it can stand, by name.
    tasks : tuple of Task
    name : str
        Of those that come with Clepsydra, or the path of its file.
    variant : int
        0 for the parameters of the files.
    """

    title: str = line("one line for people")
    text: tuple[str, ...] = paragraphs("what comes before the first task")
    process: Process = process_field()
    controllers: tuple[Controller, ...] = controllers_field()
    hides: tuple[str, ...] = part(
        _hides, **told.names("parameters that the page does not show: the reader is to find them")
    )
    setups: dict[str, SetUp] = part(
        _setups, **told.by_name("a table for each other set-up of the rig", table_schema(SetUp))
    )
    tasks: tuple[Task, ...] = part(
        _tasks, required=(OWN,), **told.listed("what is to be done", table_schema(Task), 1)
    )
    name: str = ""
    variant: int = 0

    @property
    def address(self) -> str:
        """What a user types to read it again: "wind-up#7"."""
        return numbered(self.name, self.variant)

    @property
    def file_stem(self) -> str:
        """What its files are called: "wind-up-7"."""
        return stem_of(self.address)

    @property
    def ways(self) -> dict[str, tuple[str, Process]]:
        """Title and process of every set-up by name, the rig as it is first."""
        own = {"": (self.process.title, self.process)}
        return own | {name: (each.title, each.process) for name, each in self.setups.items()}

    def rig(self, numbers: Mapping[str, Numbers] | None = None) -> Rig:
        """Return the rig under all controllers, with the numbers of a page if there is one."""
        made = _controllers(self.controllers, self.setups)
        return Rig(analyse(self.process).model, made, numbers or {})


def lesson_names() -> list[str]:
    """Return the names of the lessons that come with Clepsydra, sorted.

    Examples
    --------
    >>> "wind-up" in lesson_names()
    True
    """
    return sorted(path.stem for path in Path(str(resources.files(_FOLDER))).glob("*.toml"))


def stem_of(address: str) -> str:
    """Return what files about a lesson are called.

    Examples
    --------
    >>> stem_of("lessons/wind-up.toml#7"), stem_of("wind-up")
    ('wind-up-7', 'wind-up')
    """
    name, number = split_number(address)
    return f"{Path(name).stem}-{number}" if number else Path(name).stem


def names_lesson(text: str) -> bool:
    """Return whether a text names a lesson: one of Clepsydra's, or a file with tasks.

    A file that cannot be read is none: whoever reads it as something else says what is wrong.

    Examples
    --------
    >>> names_lesson("wind-up#7"), names_lesson("quadruple-tank")
    (True, False)
    """
    try:
        name, _ = split_number(text)
        if name in lesson_names():
            return True
        content = read_input(Path(name), "a lesson") if name.endswith(".toml") else b""
        return bool(content) and kind_of(parse(content, name, "lesson")) == "lesson"
    except InputError:
        return False


def read_lesson(name_or_path: str | Path) -> Lesson:
    """Read a lesson of Clepsydra's or of a file.

    Parameters
    ----------
    name_or_path : str or Path
        A name such as "wind-up", or the path of a TOML file. A number behind a sign, "wind-up#7",
        draws holes, splits and gains of its rig.

    Raises
    ------
    InputError
        There is no such lesson, or its file is wrong: the message names the line.

    Examples
    --------
    >>> lesson = read_lesson("wind-up")
    >>> lesson.title, len(lesson.tasks) > 1
    ('Wind-up', True)
    """
    name, number = split_number(str(name_or_path))
    path = Path(name)
    if name in lesson_names():
        path = Path(str(resources.files(_FOLDER) / f"{name}.toml"))
    elif path.suffix != ".toml":
        names = lesson_names()
        raise InputError(
            "lesson", name[:60], f"a lesson ({', '.join(names)}) or the path of a .toml file",
            suggestion(name, names, "choose one of them, or check the path"),
        )  # fmt: skip
    content = read_input(path, "a lesson", inside="the .toml file")
    table = TableReader(parse(content, name, "lesson"), (), keys_of(Lesson))
    fields = read_fields(Lesson, table, folder=path.parent, variant=number)
    return Lesson(**fields, name=name, variant=number)
