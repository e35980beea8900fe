"""One controller of a study file: by a design, or written out."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.design_arguments import design_keys, read_arguments, with_model
from clepsydra.studies.file.design_names import DESIGN_NAMES
from clepsydra.studies.file.fuzzy_table import FUZZY_KEYS, read_fuzzy_table
from clepsydra.studies.file.own_law_table import OWN_LAW_KEYS, read_own_law
from clepsydra.studies.file.placed import placed
from clepsydra.studies.file.request import ControllerRequest, Maker
from clepsydra.studies.file.scheme import SCHEME_KEYS, read_scheme
from clepsydra.studies.file.start_stop_table import START_STOP_KEYS, read_start_stop
from clepsydra.studies.file.tuning_reader import TUNING_KEYS, read_tuning
from clepsydra.studies.file.tuning_request import TuningRequest
from clepsydra.studies.file.weight_bounds import WeightedStart
from clepsydra.studies.tuning.lqi_weights import WeightedDesign
from clepsydra.studies.tuning.weighted_designs import WEIGHTED_DESIGNS

#: What makes a controller, and how it is tuned after that.
_Made = tuple[Maker, TuningRequest | None]
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
    process : Process
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
    ways = {
        "design": ("design",),
        "law": ("law",),
        "fuzzy": ("fuzzy",),
        "start_stop": ("start_stop",),
        "loops": SCHEME_KEYS,
    }
    written = [way for way, keys in ways.items() if any(table.has(key) for key in keys)]
    if len(written) != 1:
        shown = " and ".join(written) if written else "neither a design nor a loop"
        raise InputError(
            rows.place(name),
            shown,
            "one way to make a controller: design, loops, start_stop, law or fuzzy",
            "give each controller a name of its own" if written else _WAYS,
        )
    make, tune = _READERS[written[0]](rows, name, process, folder)
    return ControllerRequest(name, _checked(make, tune), tune, rows.place(name))


def _scheme(rows: TableReader, name: str, process: Process, folder: Path) -> _Made:
    table = rows.table(name, "a table", _WAYS, (*SCHEME_KEYS, "tune"))
    scheme = read_scheme(table, name, process)
    tune = _tuning(table, process)
    return lambda analysis, model: scheme.controller(analysis.operating_point), tune


def _start_stop(rows: TableReader, name: str, process: Process, folder: Path) -> _Made:
    table = rows.table(name, "a table", _WAYS, ("start_stop", "tune"))
    remedy = "write [controllers.NAME.start_stop]"
    levels = read_start_stop(
        table.table("start_stop", "a table", remedy, START_STOP_KEYS), name, process
    )
    tune = _tuning(table, process)
    return lambda analysis, model: levels.controller(analysis.operating_point), tune


def _own_law(rows: TableReader, name: str, process: Process, folder: Path) -> _Made:
    table = rows.table(name, "a table", _WAYS, (*OWN_LAW_KEYS, "tune"))
    own = read_own_law(table, name, process, folder)
    if table.has("tune") and isinstance(own.law, PythonLaw):
        raise table.refused(
            "tune",
            "a law in Python",
            "a law of expressions, whose candidates run as a batch",
            "write it with step_law, or leave tune out",
        )
    tune = _tuning(table, process)
    return lambda analysis, model: own.controller(model), tune


def _fuzzy(rows: TableReader, name: str, process: Process, folder: Path) -> _Made:
    table = rows.table(name, "a table", _WAYS, (*FUZZY_KEYS, "tune"))
    fuzzy = read_fuzzy_table(table, name, process, folder)
    tune = _tuning(table, process)
    return lambda analysis, model: fuzzy.controller(analysis.operating_point), tune


def _designed(rows: TableReader, name: str, process: Process, folder: Path) -> _Made:
    """Return what makes a controller by a design with the arguments of a table."""
    table = rows.table(name, "a table", _WAYS)
    known = table.text("design", "the name of a design", 'write as in design = "simc"')
    if known not in DESIGN_NAMES:
        raise table.refused(
            "design",
            known[:60],
            f"a design ({', '.join(DESIGN_NAMES)})",
            suggestion(known, DESIGN_NAMES, "choose one of them"),
        )
    design: Callable[..., Controller] = DESIGN_NAMES[known].load()
    keys = design_keys(design)
    table = rows.table(name, "a table", _WAYS, ("design", *keys, "tune"))
    arguments = read_arguments(table, design, process)

    def make(analysis: Analysis, model: LinearModel) -> Controller:
        given = with_model(arguments, analysis.model)
        if "pairing" in keys:
            given.setdefault("pairing", _pairing(table, analysis))
        with placed(table):
            found = design(analysis.model, **given)
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
    raise table.refused(
        "pairing",
        "no pairing",
        f"a pairing, since the relative gains of {process.name} suggest none",
        f'write as in pairing = {{ {process.controlled[0]} = "{process.inputs[0].name}" }}',
    )


def _tuning(
    table: TableReader,
    process: Process,
    weighted: WeightedStart | None = None,
) -> TuningRequest | None:
    if not table.has("tune"):
        return None
    rows = table.table("tune", "a table", "write [controllers.NAME.tune]", TUNING_KEYS)
    return read_tuning(rows, process, weighted)


def _checked(make: Maker, tune: TuningRequest | None) -> Maker:
    """Return what makes a controller and sees whether it can be tuned as asked."""
    if tune is None:
        return make

    def checked(analysis: Analysis, model: LinearModel) -> Controller:
        controller = make(analysis, model)
        tune.check(controller, model)
        return controller

    return checked


#: How a controller is read, by the key that says in which way it is made.
_READERS: dict[str, Callable[[TableReader, str, Process, Path], _Made]] = {
    "design": _designed,
    "loops": _scheme,
    "start_stop": _start_stop,
    "law": _own_law,
    "fuzzy": _fuzzy,
}
