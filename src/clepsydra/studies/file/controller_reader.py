"""One controller of a study file: by a design, or written out."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.design import DESIGNS
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.declared import read_fields, table_schema
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_name
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.design_arguments import read_arguments, with_model
from clepsydra.studies.file.fields import table_below
from clepsydra.studies.file.fuzzy_table import FuzzyTable
from clepsydra.studies.file.own_law_table import OwnLawTable
from clepsydra.studies.file.regulator_table import RegulatorTable
from clepsydra.studies.file.request import ControllerRequest, Maker
from clepsydra.studies.file.scheme import Scheme
from clepsydra.studies.file.start_stop_table import StartStopTable
from clepsydra.studies.file.tuning_reader import Tuning, WeightedStart, read_tuning
from clepsydra.studies.file.written import Written
from clepsydra.studies.tuning.weight_space import WEIGHTED_DESIGNS, WeightedDesign

_LONGEST_NAME = 60
_WAYS = 'write design = "simc", or a loop as in [controllers.NAME.loops.NAME]'


def read_controllers(
    general: TableReader, process: Process, folder: Path
) -> tuple[ControllerRequest, ...]:
    """Read the controllers of a study file; none where it names none.

    Parameters
    ----------
    general : TableReader
        The whole study file.
    folder : Path
        Where the study file is.

    Raises
    ------
    InputError
        A name is no line of text or stands twice, but for blanks and capitals; a controller is
        neither designed nor written out; or something about it is wrong.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b"[controllers.tight]\\ndesign = 'simc'\\nclosed_loop_time_constant = '5 min'"
    >>> process = load_process("equalisation-tank")
    >>> general = TableReader(parse(text, "a.toml"), (), None)
    >>> (request,) = read_controllers(general, process, Path())
    >>> analysis = analyse(process)
    >>> controller = request.make(analysis, analysis.model)
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
        alike = " ".join(name.casefold().split())
        if alike in seen:
            raise rows.refused(
                name,
                name,
                f"a name of its own, not that of {seen[alike]!r}",
                "rename one of the two",
            )
        seen[alike] = name
    return tuple(_controller(rows, name, process, folder) for name in rows.present)


def _controller(rows: TableReader, name: str, process: Process, folder: Path) -> ControllerRequest:
    """Read one controller in the way that its keys say."""
    table = rows.table(name, "a table", _WAYS)
    ways = {"design": ("design",), **{way: _said_by(way) for way in _WRITTEN}}
    written = [way for way, keys in ways.items() if any(map(table.has, keys))]
    if len(written) != 1:
        shown = " and ".join(written) if written else "neither a design nor a loop"
        raise InputError(
            rows.place(name),
            shown,
            "one way to make a controller: design, loops, start_stop, law, fuzzy or regulator",
            "give each controller a name of its own" if written else _WAYS,
        )
    if written == ["design"]:
        make, tune = _designed(rows, name, process)
    else:
        way = _WRITTEN[written[0]]
        table = rows.table(name, "a table", _WAYS, (*way.properties(), *_TUNE))
        made = way.read(table, name, process, folder).maker()
        make, tune = lambda analysis, model: made(model), _tuning(table, process)
    return ControllerRequest(name, _checked(make, tune), tune, rows.place(name))


def _designed(rows: TableReader, name: str, process: Process) -> tuple[Maker, Tuning | None]:
    """Return what makes a controller by a design with the arguments of a table."""
    table = rows.table(name, "a table", _WAYS)
    known = table.text("design", "the name of a design", 'write as in design = "simc"')
    known_name(table, "design", known, DESIGNS, "a design")
    design = DESIGNS[known]
    keys = design.file_keys
    table = rows.table(name, "a table", _WAYS, ("design", *keys, "tune"))
    arguments = read_arguments(table, design, process)

    def make(analysis: Analysis, model: LinearModel) -> Controller:
        given = with_model(arguments, analysis.model)
        if "pairing" in keys:
            given.setdefault("pairing", _pairing(table, analysis))
        with errors_at(table, {"form": table.place("actions")}):
            found = design.function(analysis.model, **given)
        return dataclasses.replace(found, name=name)

    weighted = WEIGHTED_DESIGNS.get(known)
    if weighted is None:
        return make, _tuning(table, process)

    def start(controller: Controller, model: LinearModel) -> WeightedDesign:
        designed = model.select(outputs=process.controlled)
        return weighted(designed, **with_model(arguments, designed))._replace(controller=controller)

    return make, _tuning(table, process, weighted=start)


def _pairing(table: TableReader, analysis: Analysis) -> tuple[tuple[str, str], ...]:
    if analysis.pairing:
        return analysis.pairing
    process = analysis.operating_point.process
    raise table.wrong(
        "pairing",
        f"a pairing, since the relative gains of {process.name} suggest none",
        f'write as in pairing = {{ {process.controlled[0]} = "{process.inputs[0].name}" }}',
    )


def _tuning(
    table: TableReader,
    process: Process,
    weighted: WeightedStart | None = None,
) -> Tuning | None:
    rows = read_fields(_Tuned, table)["tune"]
    return None if rows is None else read_tuning(rows, process, weighted)


def _checked(make: Maker, tune: Tuning | None) -> Maker:
    """Return what makes a controller and sees whether it can be tuned as asked."""
    if tune is None:
        return make

    def checked(analysis: Analysis, model: LinearModel) -> Controller:
        controller = make(analysis, model)
        tune.space(controller, model)
        return controller

    return checked


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


def controller_schema() -> dict[str, Any]:
    """Return the JSON Schema of a controller: by its design, or written out.

    Examples
    --------
    >>> controller_schema()["properties"]["as_published"]["type"]
    'boolean'
    """
    design = {"design": told.choice("how it is made", [*DESIGNS])}
    kinds: list[Mapping[str, Any]] = []
    checks: list[Mapping[str, Any]] = []
    for name, each in DESIGNS.items():
        own: Mapping[str, Any] = {
            key: schema for a in each.declared.values() for key, schema in a.properties.items()
        }
        kinds.append(own)
        named = {"properties": {"design": {"const": name}}, "required": ["design"]}
        fitting = told.table({**design, **own, **_TUNE}, ("design", *each.required))
        checks.append({"if": named, "then": fitting})
    ways: list[Mapping[str, Any]] = [{"required": ["design"]}]
    for way, kind in _WRITTEN.items():
        own = kind.properties()
        kinds.append(own)
        ways.append({"anyOf": [{"required": [key]} for key in _said_by(way)]})
        checks.append({"if": ways[-1], "then": {"propertyNames": {"enum": [*own, *_TUNE]}}})
    properties: dict[str, Any] = {**design}
    for keys in kinds:  # what a key of two kinds has in common is its words
        for key, schema in keys.items():
            known = properties.setdefault(key, schema)
            properties[key] = known if known == schema else {"description": known["description"]}
    return told.table(properties | _TUNE, (), {"oneOf": ways}, *checks)
