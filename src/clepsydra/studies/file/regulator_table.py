"""A controller whose matrices stand in a MAT file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

from clepsydra.controllers.controller import Controller
from clepsydra.designs.regulator import (
    ActsOn,
    RegulatorAntiWindup,
    regulator_controller,
)
from clepsydra.designs.regulators.given import SAMPLING_PERIOD, given_regulator
from clepsydra.designs.regulators.mat_file import read_mat
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_names
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.request import WrittenMaker

_CHOICES = {"acts_on": get_args(ActsOn), "anti_windup": get_args(RegulatorAntiWindup)}
REGULATOR = told.table(
    {
        "regulator": told.text("path of the MAT file with A, B, C and D"),
        "sampling_period": told.quantity("of one that is sampled already, where the file lacks Ts"),
        "measurements": told.names("list of controlled measurements, one for each input of it"),
        "manipulated": told.names("list of manipulated variables, one for each output of it"),
        "units": told.by_name("table of signals with the unit of its numbers", {"type": "string"}),
        "acts_on": told.choice("what its inputs are", _CHOICES["acts_on"]),
        "anti_windup": told.choice("whether it is told what was applied", _CHOICES["anti_windup"]),
    },
    ("regulator",),
)


def read_regulator(table: TableReader, name: str, process: Process, folder: Path) -> WrittenMaker:
    """Read the regulator that a controller names, and how it is wired.

    Parameters
    ----------
    table : TableReader
        With the keys of `REGULATOR`.
    name : str
        Of the controller.
    process : Process
    folder : Path
        Of the study file, where the path of the MAT file starts.

    Raises
    ------
    InputError
        There is no such file, a matrix in it is wrong, or a key is.

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from scipy.io import savemat
    >>> from clepsydra.process.document import parse
    >>> text = b'''regulator = "reg1.mat"
    ... measurements = ["level_1"]
    ... manipulated = ["pump_1"]
    ... '''
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     savemat(Path(folder) / "reg1.mat", {"A": 0.0, "B": 0.1, "C": 1.0, "D": 3.0})
    ...     table = TableReader(parse(text, "study.toml"), (), REGULATOR["properties"])
    ...     make = read_regulator(table, "mine", plant.process, Path(folder))
    >>> make(plant.linear).initial_state["pump_1.last_output"]
    3.0
    """
    expected, remedy = "the name of a MAT file", 'write as in regulator = "reg1.mat"'
    written = table.text("regulator", expected, remedy)
    if not (folder / written).is_file():
        raise table.refused(
            "regulator", written[:60], f"{expected} that exists, from {folder}/", remedy
        )
    regulator = read_mat(folder / written)
    arguments: dict[str, Any] = {
        key: table.choice(key, choices, choices[0]) for key, choices in _CHOICES.items()
    }
    if table.has(SAMPLING_PERIOD.name):
        with errors_at(table, {"sampling period": table.place(SAMPLING_PERIOD.name)}):
            regulator = given_regulator(regulator, float(table.declared(SAMPLING_PERIOD, {}, None)))
    known = {
        "measurements": list(process.controlled),
        "manipulated": [signal.name for signal in process.inputs],
    }
    for key, names in known.items():
        if table.has(key):
            arguments[key] = known_names(
                names,
                table,
                key,
                expected=f"a list of {key}",
                remedy=f'write as in ["{names[0]}"]',
                each=f"one of {', '.join(names)}",
            )
    if table.has("units"):
        remedy = f'write as in units = {{ {known["measurements"][0]} = "cm" }}'
        rows = table.table("units", "signals with their units", remedy)
        arguments["units"] = {each: rows.text(each, "a unit", remedy) for each in rows.present}

    # What only the plant shows to be wrong with the matrices is told where the file is named.
    matrices = dict.fromkeys(("A", "sampling period"), table.place("regulator"))

    def make(model: LinearModel) -> Controller:
        with errors_at(table, matrices):
            return regulator_controller(model, regulator, name=name, **arguments)

    return make
