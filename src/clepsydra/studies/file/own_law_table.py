"""A controller whose step law a user wrote in a Python file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.own_law import load_law
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.designs.own_law import own_controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_names
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.law_parameters import LawParameters
from clepsydra.studies.file.request import WrittenMaker

#: What one of a kind is called, and what a law's signal is of it.
_KINDS = {
    "measurements": ("measurement", "pv"),
    "setpoints": ("setpoint", "sp"),
    "manipulated": ("manipulated", "out"),
}
OWN_LAW = told.table(
    {
        "law": told.text("path of the Python file"),
        "measurements": told.names("list of sensors, one for each `pv` of the law in its order"),
        "setpoints": told.names("list of controlled measurements, one for each `sp`"),
        "manipulated": told.names("list of manipulated variables, one for each `out`"),
        "parameters": told.by_name("table of values that differ from those in the file"),
        "initial_state": told.by_name("table of states at the operating point"),
    },
    ("law",),
)


def read_own_law(table: TableReader, name: str, process: Process, folder: Path) -> WrittenMaker:
    """Run the Python file that a controller names, and read how its law is wired.

    The outputs of the controller start at the operating point.

    Parameters
    ----------
    table : TableReader
        With the keys of `OWN_LAW`.
    name : str
        Of the controller.
    process : Process
    folder : Path
        Of the study file, where the path of the Python file starts.

    Raises
    ------
    InputError
        The file holds no law, or a name or number is none of it or of the process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from clepsydra.process.document import parse
    >>> code = '''inputs = ["level.pv"]
    ... outputs = ["pump.out"]
    ... parameters = {"gain": 2.0}
    ... def step(state, inputs, parameters, time_step):
    ...     return {}, {"pump.out": parameters["gain"] * inputs["level.pv"]}
    ... '''
    >>> text = b'''law = "half.py"
    ... measurements = ["level_1"]
    ... manipulated = ["pump_1"]
    ... parameters = { gain = 0.5 }
    ... '''
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "half.py").write_text(code)
    ...     table = TableReader(parse(text, "study.toml"), (), None)
    ...     make = read_own_law(table, "mine", plant.process, Path(folder))
    >>> make(plant.linear).values["gain"]
    0.5
    """
    expected, remedy = "the name of a Python file", 'write as in law = "my_law.py"'
    written = table.text("law", expected, remedy)
    if not written.endswith(".py") or not (folder / written).is_file():
        raise table.refused("law", written[:60], f"{expected} that exists, from {folder}/", remedy)
    try:
        law = load_law(folder / written)
    except InputError as error:
        # Both matter: what names the law, and the line of the law that is wrong.
        place = f"{table.place('law')}, {error.place}"
        raise InputError(place, error.value, error.expected, error.remedy) from None
    known = {
        "measurements": [signal.name for signal in process.measurements],
        "setpoints": list(process.controlled),
        "manipulated": [signal.name for signal in process.inputs],
    }
    measurements, setpoints, manipulated = (
        _names(table, key, names, law) for key, names in known.items()
    )
    parameters = {parameter.name: parameter for parameter in law.parameters}
    state = {entry.name: entry for entry in law.state if isinstance(entry, Signal)}
    values = _numbers(table, "parameters", parameters)
    initial_state = _numbers(table, "initial_state", state)
    if table.has("tune") and isinstance(law, PythonLaw):
        raise table.refused(
            "tune",
            "a law in Python",
            "a law of expressions, whose candidates run as a batch",
            "write it with step_law, or leave tune out",
        )

    def make(model: LinearModel) -> Controller:
        with errors_at(table):
            return own_controller(
                model,
                law,
                measurements=measurements,
                setpoints=setpoints,
                manipulated=manipulated,
                values=values,
                initial_state=initial_state,
                name=name,
            )

    return make


def _names(table: TableReader, key: str, known: list[str], law: StepLaw) -> tuple[str, ...]:
    """Return the process signals for one kind of signal of the law, one for each."""
    words, part = _KINDS[key]
    count = len(owners([*law.inputs, *law.outputs], part))
    if not table.has(key) and count == 0:
        return ()
    found = known_names(
        known,
        table,
        key,
        expected=f"a list of {count} names, one for each {words} of the law",
        remedy=f'write as in ["{known[0]}"]',
        each=f"one of {', '.join(known)}",
    )
    if len(found) != count:
        raise table.refused(
            key,
            ", ".join(found),
            f"{count} names, one for each {words} of the law",
            "add or remove names",
        )
    return found


def _numbers(table: TableReader, key: str, known: Mapping[str, Signal]) -> dict[str, float]:
    if not table.has(key):
        return {}
    remedy = f"write as in {key} = {{ {next(iter(known), 'gain')} = 1.0 }}"
    rows = table.table(key, "names of the law with their values", remedy, tuple(known))
    law = LawParameters(known)
    return {
        name: law.read(rows, name, name, "a number", "give it in the unit of the law")
        for name in rows.present
    }
