"""A controller whose matrices stand in a MAT file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

from clepsydra.controllers.controller import Controller
from clepsydra.designs.regulator import (
    ActsOn,
    RegulatorAntiWindup,
    regulator_controller,
)
from clepsydra.designs.regulators.given import (
    SAMPLING_PERIOD,
    GivenRegulator,
    given_regulator,
)
from clepsydra.designs.regulators.mat_file import read_mat
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.declared import choice, part
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_names
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.fields import file_beside
from clepsydra.studies.file.written import Written, WrittenMaker


def _named(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...] | None:
    """Return the signals of one side of the regulator; None for those that are usual."""
    process = known["process"]
    names = [*process.controlled] if key == "measurements" else [u.name for u in process.inputs]
    return known_names(names, table, key, expected=f"a list of {key}") if table.has(key) else None


def _units(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, str] | None:
    if not table.has(key):
        return None
    remedy = f'write as in units = {{ {known["process"].controlled[0]} = "cm" }}'
    rows = table.table(key, "signals with their units", remedy)
    return {each: rows.text(each, "a unit", remedy) for each in rows.present}


@dataclass(frozen=True)
class RegulatorTable(Written):
    """The regulator of a MAT file, and how it is wired.

    Raises
    ------
    InputError
        There is no such file, a matrix in it is wrong, or a key is.

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from pathlib import Path
    >>> from scipy.io import savemat
    >>> from clepsydra.process.document import parse
    >>> text = b'''regulator = "reg1.mat"
    ... measurements = ["level_1"]
    ... manipulated = ["pump_1"]
    ... '''
    >>> plant = cl.load("quadruple-tank")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     savemat(Path(folder) / "reg1.mat", {"A": 0.0, "B": 0.1, "C": 1.0, "D": 3.0})
    ...     table = TableReader(parse(text, "study.toml"), (), None)
    ...     make = RegulatorTable.read(table, "mine", plant.process, Path(folder)).maker()
    >>> make(plant.linear).initial_state["pump_1.last_output"]
    3.0
    """

    regulator: GivenRegulator = file_beside(
        "path of the MAT file with A, B, C and D",
        "the name of a MAT file",
        'write as in regulator = "reg1.mat"',
        read_mat,
    )
    sampling_period: float | None = part(
        lambda table, key, known: table.declared(SAMPLING_PERIOD, {}, None),
        **told.quantity("of one that is sampled already, where the file lacks Ts"),
    )
    measurements: tuple[str, ...] | None = part(
        _named, **told.names("list of controlled measurements, one for each input of it")
    )
    manipulated: tuple[str, ...] | None = part(
        _named, **told.names("list of manipulated variables, one for each output of it")
    )
    units: dict[str, str] | None = part(
        _units, **told.by_name("table of signals with the unit of its numbers", {"type": "string"})
    )
    acts_on: ActsOn = choice(get_args(ActsOn), words="what its inputs are")
    anti_windup: RegulatorAntiWindup = choice(
        get_args(RegulatorAntiWindup), words="whether it is told what was applied"
    )

    def maker(self) -> WrittenMaker:
        """Give it the sampling period that the file lacks."""
        table, regulator = self.table, self.regulator
        if self.sampling_period is not None:
            with errors_at(table, {"sampling period": table.place(SAMPLING_PERIOD.name)}):
                regulator = given_regulator(regulator, self.sampling_period)
        # What only the plant shows to be wrong with the matrices is told where the file is named.
        matrices = dict.fromkeys(("A", "sampling period"), table.place("regulator"))

        def make(model: LinearModel) -> Controller:
            with errors_at(table, matrices):
                return regulator_controller(
                    model,
                    regulator,
                    measurements=self.measurements,
                    manipulated=self.manipulated,
                    units=self.units,
                    acts_on=self.acts_on,
                    anti_windup=self.anti_windup,
                    name=self.name,
                )

        return make
