"""A way in which the rig of a lesson can stand, with the controllers that belong to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.laboratory.lessons.told_text import line
from clepsydra.laboratory.setups import is_alike
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.linearise import linearise
from clepsydra.process import told
from clepsydra.process.declared import OWN, keys_of, part, read_fields
from clepsydra.process.drawn import drawn
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.controller_reader import read_controllers
from clepsydra.studies.file.reader import process_beside

_PROCESS = told.text(
    "a process of the catalogue, or the path of a process file, from the folder of the lesson"
)


def process_field() -> Any:
    """Return the field of the process of a set-up, as the number of the variant draws it."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> Process:
        return drawn(process_beside(table, key, known), known["variant"])

    return part(read, required=(OWN,), **_PROCESS)


def controllers_field() -> Any:
    """Return the field of the controllers of a set-up, designed for it as it was drawn."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[Controller, ...]:
        return _made(table, known["process"], known["folder"])

    return part(read, **told.by_name("a table for each controller", {"type": "object"}))


@dataclass(frozen=True, eq=False, kw_only=True)
class SetUp:
    """The rig with other parameters.

    Parameters
    ----------
    title : str
    process : Process
        Which differs from the rig's in parameters alone.
    controllers : tuple of Controller
    """

    title: str = line("what it is called")
    process: Process = process_field()
    controllers: tuple[Controller, ...] = controllers_field()


def read_set_ups(
    table: TableReader, key: str, rig: Process, folder: Path, variant: int
) -> dict[str, SetUp]:
    """Read the set-ups of a lesson beside the rig as it is.

    Raises
    ------
    InputError
        One is of another plant, or something in it is wrong.
    """
    if not table.has(key):
        return {}
    rows = table.table(key, "a table for each set-up", "write [setups.NAME]")
    found = {}
    for name in rows.present:
        row = rows.table(name, "a table", f"write [setups.{name}]", keys_of(SetUp))
        found[name] = SetUp(**read_fields(SetUp, row, folder=folder, variant=variant))
        if not is_alike(found[name].process, rig):
            expected = f"a process that differs from {rig.name} in parameters alone"
            remedy = "another plant is another lesson"
            raise row.wrong("process", expected, remedy)
    return found


def _made(table: TableReader, process: Process, folder: Path) -> tuple[Controller, ...]:
    """Design what `controllers` asks for."""
    requests = read_controllers(table, process, folder)
    if not requests:
        return ()
    analysis: Analysis = analyse(process)
    measured = linearise(analysis.operating_point)
    found = []
    for request in requests:
        place = table.place("controllers", request.name)
        if request.tune is not None:
            raise InputError(
                f"{place}.tune", request.name, "a controller without tuning by simulation, which "
                "differs in its last digits from machine to machine",
                "write the settings that the tuning found",
            )  # fmt: skip
        try:
            found.append(request.make(analysis, measured))
        except NotApplicable as reason:
            expected = f"a controller that applies; this one does not: {reason}"
            raise InputError(place, request.name, expected, "choose another") from None
    return tuple(found)
