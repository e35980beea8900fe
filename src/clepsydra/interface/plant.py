"""A plant: a process at an operating point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import ClepsydraError
from clepsydra.base.keywords import keywords_checked
from clepsydra.base.section import Mark, Section, Table, marked
from clepsydra.interface.analysis import Analysis
from clepsydra.interface.quantities import Quantity, check_within, read_values
from clepsydra.interface.shown import Answered, lifted
from clepsydra.linear.analysis import analyse
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

if TYPE_CHECKING:
    from clepsydra.base.signal import Signal
    from clepsydra.linear.equilibrium_request import Asked
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.linear.operating_point import OperatingPoint


class Plant(Answered):
    """A process at an operating point: what is analysed, controlled, simulated and studied.

    `load` makes one. Printed, it lists its signals with their units, ranges and values at rest.

    Parameters
    ----------
    process : Process
    inputs, outputs, disturbances : mapping, optional
        What fixes the operating point; that of the process file if left out. Signal to text with a
        unit, or to a number in the display unit that the printed plant shows.

    Raises
    ------
    InputError
        A signal is unknown, or a quantity is none of its signal.
    """

    def __init__(
        self,
        process: Process,
        *,
        inputs: Mapping[str, Quantity] | None = None,
        outputs: Mapping[str, Quantity] | None = None,
        disturbances: Mapping[str, Quantity] | None = None,
    ) -> None:
        require_type(process, Process, "plant", "a process", 'write cl.load("quadruple-tank")')
        self.process = process
        self.asked: Asked = {
            "inputs": self._read("inputs", inputs, process.inputs),
            "outputs": self._read("outputs", outputs, process.measurements),
            "disturbances": self._read("disturbances", disturbances, process.disturbances),
        }

    @classmethod
    def resting(cls, process: Process, asked: Asked) -> Plant:
        """Return a process at the operating point that values in SI fix."""
        plant = cls(process)
        plant.asked = asked
        return plant

    @keywords_checked('write as in plant.at(outputs={"level_1": "4 V"})')
    def at(
        self,
        *,
        inputs: Mapping[str, Quantity] | None = None,
        outputs: Mapping[str, Quantity] | None = None,
        disturbances: Mapping[str, Quantity] | None = None,
    ) -> Plant:
        """Return the same process at another operating point.

        Parameters
        ----------
        inputs, outputs, disturbances : mapping, optional
            Signal to text with a unit, or to a number in its display unit.

        Examples
        --------
        >>> plant = load("quadruple-tank").at(outputs={"level_1": "4 V", "level_2": 4.0})
        >>> round(plant.point.as_dict()["pump_1"], 2)
        2.48
        """
        return Plant(self.process, inputs=inputs, outputs=outputs, disturbances=disturbances)

    @keywords_checked('write as in plant.with_values({"tank_1.area": "30 cm^2"})')
    def with_values(self, values: Mapping[str, Quantity]) -> Plant:
        """Return a plant with other physical parameters, at the operating point asked for there.

        Parameters
        ----------
        values : mapping
            Parameter, "tank_1.area", to text with a unit or to a number in its display unit.

        Examples
        --------
        >>> bigger = load("quadruple-tank").with_values({"tank_1.area": "30 cm^2"})
        >>> bigger.process.signal("tank_1.area").initial
        0.003

        Raises
        ------
        InputError
            A parameter is unknown, or a value no quantity of it or beyond what it can be.
        """
        remedy, words = 'write as in {"tank_1.area": "30 cm^2"}', "parameters with their values"
        require_type(values, Mapping, "plant, values", words, remedy)
        words = f"a parameter of {self.process.name}"
        found = read_values("plant, values", values, self.process.parameters, words)
        for name, value in found.items():
            parameter = self.process.signal(name)
            check_within("plant, values", name, parameter, value, values[name], "a value")
        return Plant.resting(self.process.with_parameters(found), self.asked)

    def equilibrium(self) -> OperatingPoint:
        """Return the operating point alone, without an analysis.

        Raises
        ------
        NoEquilibrium
            It never rests as asked.
        """
        return find_equilibrium(self.process, **self.asked)

    @cached_property
    def analysis(self) -> Analysis:
        """What the linear model says about it, as `cl.analyse` returns it."""
        found = analyse(self.process, **self.asked)
        return lifted(Analysis, found)

    @property
    def point(self) -> OperatingPoint:
        """The operating point."""
        return self.analysis.operating_point

    @property
    def asked_for(self) -> OperatingPoint | None:
        """The operating point where one was asked for; None for that of the process file."""
        return None if all(each is None for each in self.asked.values()) else self.point

    @property
    def linear(self) -> LinearModel:
        """The linear model from inputs to controlled measurements; it has `to_control()`."""
        return self.analysis.model

    @property
    def file_stem(self) -> str:
        """What reports and data of it are called."""
        return self.process.file_stem

    @cached_property
    def measured(self) -> LinearModel:
        """The linear model from all inputs to every measurement."""
        return linearise(self.point)

    @property
    def name(self) -> str:
        """The name of the process."""
        return self.process.name

    def _read(
        self, what: str, given: Mapping[str, Quantity] | None, signals: Sequence[Signal]
    ) -> dict[str, float] | None:
        if given is None:
            return None
        place = f"operating point, {what}"
        require_type(
            given, Mapping, place, "signals with their values", 'write as in {"level_1": "5 V"}'
        )
        words = {"inputs": "an input", "outputs": "a measurement", "disturbances": "a disturbance"}
        return read_values(place, given, signals, f"{words[what]} of {self.process.name}")

    def answer(self) -> Section:
        """Return its signals with ranges and values at rest."""
        from clepsydra.base.units import unit_text
        from clepsydra.report.quantities import (
            quantity_text,
        )

        process = self.process
        notes: tuple[str, ...] = ()
        try:
            rest = self.point.as_dict()
        except ClepsydraError as error:
            rest, notes = {}, (str(error),)
        rows = []
        kinds = (
            ("manipulated", process.inputs),
            ("measured", process.measurements),
            ("disturbance", process.disturbances),
            ("state", process.state),
        )
        for kind, signals in kinds:
            for signal in signals:
                tag = process.tags.get(signal.name)
                shown = "controlled" if signal.name in process.controlled else kind
                value = quantity_text(signal, rest[signal.name]) if signal.name in rest else "–"
                low, high = (quantity_text(signal, end) for end in (signal.low, signal.high))
                rows.append(
                    (
                        f"{signal.name} ({tag})" if tag else signal.name,
                        shown,
                        value,
                        f"{low} to {high}",
                        unit_text(signal.shown_unit) or "1",
                    )
                )
        head = ("signal", "what it is", "at rest", "range", "unit")
        title = f"{process.title} ({process.address})"
        table = Table("Signals", head, tuple(rows), names=2)
        return Section(title, (table, *marked(Mark.WATCH, notes)))


@keywords_checked()
def load(
    name_or_path: str | Path,
    *,
    variant: str | Sequence[str] | None = None,
    inputs: Mapping[str, Quantity] | None = None,
    outputs: Mapping[str, Quantity] | None = None,
    disturbances: Mapping[str, Quantity] | None = None,
) -> Plant:
    """Load a plant: a process of the catalogue or of a file, at an operating point.

    Parameters
    ----------
    name_or_path : str or Path
        A name of the catalogue, "quadruple-tank", or the path of a TOML file. Variants may follow a
        colon, "averaging-tank:inflow-constant".
    variant : str or sequence of str, optional
        Variants of the file; its own default if left out.
    inputs, outputs, disturbances : mapping, optional
        What fixes the operating point; that of the file if left out. Signal to text with a unit, or
        to a number in its display unit.

    Raises
    ------
    InputError
        There is no such process, its file is wrong, or a quantity is; the message says where.

    Examples
    --------
    >>> plant = load("quadruple-tank")
    >>> plant.point.as_dict()["pump_1"]
    3.0
    """
    process = load_process(name_or_path, variant)
    return Plant(process, inputs=inputs, outputs=outputs, disturbances=disturbances)
