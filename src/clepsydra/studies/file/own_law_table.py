"""A controller whose step law a user wrote in a Python file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.own_law import load_law
from clepsydra.controllers.signals import owners
from clepsydra.designs.own_law import own_controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.names_among import names_among
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.law_parameters import LawParameters
from clepsydra.studies.file.placed import placed

#: What one of a kind is called, and what a law's signal is of it.
_KINDS = {
    "measurements": ("measurement", "pv"),
    "setpoints": ("setpoint", "sp"),
    "manipulated": ("manipulated", "out"),
}
OWN_LAW_KEYS = ("law", "measurements", "setpoints", "manipulated", "parameters", "initial_state")


@dataclass(frozen=True, eq=False)
class OwnLaw:
    """A user's law, and how it is wired to the process.

    Parameters
    ----------
    table : TableReader
    name : str
    law : StepLaw
    measurements, setpoints, manipulated : tuple of str
        In the order of the law.
    values, initial_state : dict

    Examples
    --------
    See `read_own_law`.
    """

    table: TableReader
    name: str
    law: StepLaw
    measurements: tuple[str, ...]
    setpoints: tuple[str, ...]
    manipulated: tuple[str, ...]
    values: dict[str, float]
    initial_state: dict[str, float]

    def controller(self, model: LinearModel) -> Controller:
        """Return the controller, whose outputs start at the operating point of a model."""
        with placed(self.table):
            return own_controller(
                model,
                self.law,
                measurements=self.measurements,
                setpoints=self.setpoints,
                manipulated=self.manipulated,
                values=self.values,
                initial_state=self.initial_state,
                name=self.name,
            )


def read_own_law(table: TableReader, name: str, process: Process, folder: Path) -> OwnLaw:
    """Run the Python file that a controller names, and read how its law is wired.

    Parameters
    ----------
    table : TableReader
        With `OWN_LAW_KEYS`.
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
    ...     table = TableReader(parse(text, "study.toml"), (), OWN_LAW_KEYS)
    ...     own = read_own_law(table, "mine", plant.process, Path(folder))
    >>> own.controller(plant.linear).values["gain"]
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
    return OwnLaw(
        table,
        name,
        law,
        measurements,
        setpoints,
        manipulated,
        _numbers(table, "parameters", parameters),
        _numbers(table, "initial_state", state),
    )


def _names(table: TableReader, key: str, known: list[str], law: StepLaw) -> tuple[str, ...]:
    """Return the process signals for one kind of signal of the law, one for each."""
    words, part = _KINDS[key]
    count = len(owners([*law.inputs, *law.outputs], part))
    if not table.has(key) and count == 0:
        return ()
    found = names_among(
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
