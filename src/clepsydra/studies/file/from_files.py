"""Controllers that stand in a file of their own: a law, fuzzy rules, or a regulator's matrices."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import FuzzyFile, WiredFuzzy, load_fuzzy
from clepsydra.controllers.own_law import load_law
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.designs.own_law import own_controller
from clepsydra.designs.regulator import ActsOn, RegulatorAntiWindup, regulator_controller
from clepsydra.designs.regulators.given import SAMPLING_PERIOD, GivenRegulator, given_regulator
from clepsydra.designs.regulators.mat_file import read_mat
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process import told
from clepsydra.process.declared import choice, part
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_names
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.fields import file_beside
from clepsydra.studies.file.law_parameters import LawParameters
from clepsydra.studies.file.written import Written, WrittenMaker

#: Which signals of the process each key names, what one is called, and what of the law it is.
_SIDES: dict[str, tuple[Callable[[Process], Sequence[str]], str, str]] = {
    "measurements": (lambda of: [each.name for each in of.measurements], "measurement", "pv"),
    "setpoints": (lambda of: of.controlled, "setpoint", "sp"),
    "manipulated": (lambda of: [each.name for each in of.inputs], "manipulated", "out"),
}


def _wired(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the process signals for one kind of signal of the law, one for each."""
    names_of, words, kind = _SIDES[key]
    law: StepLaw = known["law"]
    count = len(owners([*law.inputs, *law.outputs], kind))
    if not table.has(key) and count == 0:
        return ()
    expected = f"a list of {count} names, one for each {words} of the law"
    found = known_names(names_of(known["process"]), table, key, expected=expected)
    if len(found) != count:
        raise table.refused(
            key,
            ", ".join(found),
            f"{count} names, one for each {words} of the law",
            "add or remove names",
        )
    return found


def _numbers(table: TableReader, key: str, known: Mapping[str, Any]) -> dict[str, float]:
    """Return the values that are given to what the law has."""
    if not table.has(key):
        return {}
    law: StepLaw = known["law"]
    owned = law.parameters if key == "parameters" else law.state
    by_name = {each.name: each for each in owned if isinstance(each, Signal)}
    remedy = f"write as in {key} = {{ {next(iter(by_name), 'gain')} = 1.0 }}"
    rows = table.table(key, "names of the law with their values", remedy, tuple(by_name))
    parameters = LawParameters(by_name)
    return {
        name: parameters.read(rows, name, name, "a number", "give it in the unit of the law")
        for name in rows.present
    }


@dataclass(frozen=True)
class OwnLawTable(Written):
    """The step law of a Python file, and how it is wired; its outputs start where the point is.

    Raises
    ------
    InputError
        The file holds no law, or a name or number is none of it or of the process.
    """

    law: StepLaw = file_beside(
        "path of the Python file",
        "the name of a Python file",
        'write as in law = "my_law.py"',
        load_law,
        ending=".py",
        told_at_key=True,  # what names the law matters as much as the line that is wrong
    )
    measurements: tuple[str, ...] = part(
        _wired, **told.names("list of sensors, one for each `pv` of the law in its order")
    )
    setpoints: tuple[str, ...] = part(
        _wired, **told.names("list of controlled measurements, one for each `sp`")
    )
    manipulated: tuple[str, ...] = part(
        _wired, **told.names("list of manipulated variables, one for each `out`")
    )
    parameters: dict[str, float] = part(
        _numbers, **told.by_name("table of values that differ from those in the file")
    )
    initial_state: dict[str, float] = part(
        _numbers, **told.by_name("table of states at the operating point")
    )

    def maker(self) -> WrittenMaker:
        """Refuse a law that cannot be tuned where it is to be."""
        if self.table.has("tune") and isinstance(self.law, PythonLaw):
            raise self.table.refused(
                "tune",
                "a law in Python",
                "a law of expressions, whose candidates run as a batch",
                "write it with step_law, or leave tune out",
            )

        def make(model: LinearModel) -> Controller:
            with errors_at(self.table):
                return own_controller(
                    model,
                    self.law,
                    measurements=self.measurements,
                    setpoints=self.setpoints,
                    manipulated=self.manipulated,
                    values=self.parameters,
                    initial_state=self.initial_state,
                    name=self.name,
                )

        return make


@dataclass(frozen=True)
class FuzzyTable(Written):
    """Sets and rules in a file; the outputs start at the operating point.

    Raises
    ------
    InputError
        There is no such file, or something in it is wrong; then the place is in that file.
    """

    fuzzy: FuzzyFile = file_beside(
        "a file of sets and rules",
        "the name of a file of sets and rules",
        'write as in fuzzy = "rules.toml"',
        load_fuzzy,
    )

    def maker(self) -> WrittenMaker:
        """Wire it to the process."""
        wired = WiredFuzzy(self.fuzzy, self.process)

        def make(model: LinearModel) -> Controller:
            with errors_at(self.table):
                return wired.controller(operating_point_of(model), self.name)

        return make


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
