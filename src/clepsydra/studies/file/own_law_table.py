"""A controller whose step law a user wrote in a Python file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.own_law import load_law
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.controllers.signals import owners
from clepsydra.designs.own_law import own_controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process import told
from clepsydra.process.declared import part
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

    Examples
    --------
    >>> import clepsydra as cl
    >>> import tempfile
    >>> from pathlib import Path
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
    ...     make = OwnLawTable.read(table, "mine", plant.process, Path(folder)).maker()
    >>> make(plant.linear).values["gain"]
    0.5
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
