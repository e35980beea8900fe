"""One controller of a study file: by a design, or written out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.arguments.of_model import OfModel
from clepsydra.designs.design import DESIGNS
from clepsydra.designs.lqi import WeighedLqi
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.declared import read_fields, table_schema
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.fields import table_below
from clepsydra.studies.file.from_files import FuzzyTable, OwnLawTable, RegulatorTable
from clepsydra.studies.file.request import ControllerRequest, Maker
from clepsydra.studies.file.scheme import Scheme
from clepsydra.studies.file.start_stop_table import StartStopTable
from clepsydra.studies.file.tuning_reader import Tuning, WeightedStart, read_tuning
from clepsydra.studies.file.written import Written
from clepsydra.studies.tuning.weight_space import WEIGHTED_DESIGNS

_LONGEST_NAME = 60
_WAYS = 'write design = "simc", or a loop as in [controllers.NAME.loops.NAME]'


def read_controllers(
    general: TableReader, process: Process, folder: Path
) -> tuple[ControllerRequest, ...]:
    """Read the controllers of a whole study file in a folder; none where it names none.

    Raises
    ------
    InputError
        A name is no line of text or stands twice, but for blanks and capitals; a controller is
        neither designed nor written out; or something about it is wrong.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.process.document import parse
    >>> text = b"[controllers.tight]\\ndesign = 'simc'\\nclosed_loop_time_constant = '5 min'"
    >>> plant = cl.load("equalisation-tank")
    >>> general = TableReader(parse(text, "a.toml"), (), None)
    >>> (request,) = read_controllers(general, plant.process, Path())
    >>> controller = request.make(plant.analysis, plant.linear)
    >>> controller.name, round(controller.values["level.integral_time"])
    ('tight', 1320)
    """
    if not general.has("controllers"):
        return ()
    rows = general.table("controllers", "a table for each controller", "write [controllers.NAME]")
    seen: dict[str, str] = {}
    for name in rows.present:
        if not name.strip() or not name.isprintable() or len(name) > _LONGEST_NAME:
            raise rows.refused(
                name,
                name[:_LONGEST_NAME],
                f"a name of 1 to {_LONGEST_NAME} characters in one line",
                "rename the controller",
            )
        known = seen.setdefault(" ".join(name.casefold().split()), name)
        if known != name:
            expected = f"a name of its own, not that of {known!r}"
            raise rows.refused(name, name, expected, "rename one of the two")
    return tuple(_controller(rows, name, process, folder) for name in rows.present)


def _controller(rows: TableReader, name: str, process: Process, folder: Path) -> ControllerRequest:
    """Read one controller in the way that its keys say."""
    table = rows.table(name, "a table", _WAYS)
    ways = {"design": ("design",), **{way: _said_by(way) for way in _WRITTEN}}
    written = [way for way, keys in ways.items() if any(map(table.has, keys))]
    if len(written) != 1:
        raise InputError(
            rows.place(name),
            " and ".join(written) or "neither a design nor a loop",
            "one way to make a controller: design, loops, start_stop, law, fuzzy or regulator",
            "give each controller a name of its own" if written else _WAYS,
        )
    if written == ["design"]:
        return _designed(rows, name, process)
    way = _WRITTEN[written[0]]
    table = rows.table(name, "a table", _WAYS, (*way.properties(), *_TUNE))
    made = way.read(table, name, process, folder).maker()
    return _request(table, name, process, lambda analysis, model: made(model))


def _designed(rows: TableReader, name: str, process: Process) -> ControllerRequest:
    """Read a controller by a design with the arguments of a table."""
    table = rows.table(name, "a table", _WAYS)
    known = table.text("design", "the name of a design", 'write as in design = "simc"')
    design = DESIGNS[known_name(table, "design", known, DESIGNS, "a design")]
    table = rows.table(name, "a table", _WAYS, ("design", *design.file_keys, "tune"))
    arguments = {
        argument: declared.read(table, argument, process)  # says what is missing
        for argument, declared in design.declared.items()
        if argument in design.required or any(map(table.has, declared.keys))
    }

    def given(model: LinearModel) -> dict[str, Any]:
        return {
            argument: value.of(model) if isinstance(value, OfModel) else value
            for argument, value in arguments.items()
        }

    def make(analysis: Analysis, model: LinearModel) -> Controller:
        found = given(analysis.model)
        if "pairing" in design.file_keys and "pairing" not in found:
            found["pairing"] = _pairing(table, analysis)
        with errors_at(table, {"form": table.place("actions")}):
            return replace(design.function(analysis.model, **found), name=name)

    weighted = WEIGHTED_DESIGNS.get(known)

    def start(controller: Controller, model: LinearModel) -> WeighedLqi:
        assert weighted is not None
        designed = model.select(outputs=process.controlled)
        return weighted(designed, **given(designed))._replace(controller=controller)

    return _request(table, name, process, make, start if weighted else None)


def _pairing(table: TableReader, analysis: Analysis) -> tuple[tuple[str, str], ...]:
    if analysis.pairing:
        return analysis.pairing
    process = analysis.operating_point.process
    raise table.wrong(
        "pairing",
        f"a pairing, since the relative gains of {process.name} suggest none",
        f'write as in pairing = {{ {process.controlled[0]} = "{process.inputs[0].name}" }}',
    )


def _request(
    table: TableReader,
    name: str,
    process: Process,
    make: Maker,
    weighted: WeightedStart | None = None,
) -> ControllerRequest:
    """Return how a controller is made, seeing whether it can be tuned as asked, and is tuned."""
    rows = read_fields(_Tuned, table)["tune"]
    if rows is None:
        return ControllerRequest(name, make, None)
    asked = {key: table.raw(key) for key in table.present}
    tune = read_tuning(rows, process, weighted, asked)

    def checked(analysis: Analysis, model: LinearModel) -> Controller:
        controller = make(analysis, model)
        tune.space(controller, model)
        return controller

    return ControllerRequest(name, checked, tune)


@dataclass(frozen=True)
class _Tuned:
    """What each controller may have beside the keys of its way."""

    tune: TableReader | None = table_below(
        Tuning, "what is tuned by simulation, and for what", "write [controllers.NAME.tune]"
    )


_TUNE = table_schema(_Tuned)["properties"]
#: The ways to write a controller out, each by a key that says so.
_WRITTEN: dict[str, type[Written]] = {
    "law": OwnLawTable,
    "fuzzy": FuzzyTable,
    "regulator": RegulatorTable,
    "start_stop": StartStopTable,
    "loops": Scheme,
}


def _said_by(way: str) -> tuple[str, ...]:
    """Return the keys any of which says that a controller is written out in a way."""
    return tuple(Scheme.properties()) if way == "loops" else (way,)


def controller_schema(*, tuned: bool = True) -> dict[str, Any]:
    """Return the JSON Schema of a controller: by its design, or written out; tuned or not."""
    tune = _TUNE if tuned else {}
    properties: dict[str, Any] = {"design": told.choice("how it is made", [*DESIGNS])}
    design, checks = dict(properties), []
    ways: list[dict[str, Any]] = [{"required": ["design"]}]

    def add(keys: Mapping[str, Any]) -> None:
        for key, schema in keys.items():  # what a key of two kinds has in common is its words
            known = properties.setdefault(key, schema)
            properties[key] = known if known == schema else {"description": known["description"]}

    for name, each in DESIGNS.items():
        own = {key: said for a in each.declared.values() for key, said in a.properties.items()}
        add(own)
        named = {"properties": {"design": {"const": name}}, "required": ["design"]}
        fitting = told.table({**design, **own, **tune}, ("design", *each.required))
        checks.append({"if": named, "then": fitting})
    for way, kind in _WRITTEN.items():
        add(kind.properties())
        ways.append({"anyOf": [{"required": [key]} for key in _said_by(way)]})
        allowed = {"propertyNames": {"enum": [*kind.properties(), *tune]}}
        checks.append({"if": ways[-1], "then": allowed})
    return told.table(properties | tune, (), {"oneOf": ways}, *checks)
