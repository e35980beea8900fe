"""Start and stop levels of pumps, written out in a study file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.parameters import check_parameters
from clepsydra.controllers.signals import owners
from clepsydra.controllers.start_stop_levels import FAMILY, check_levels, start_stop_law
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process import told
from clepsydra.process.declared import OWN, flag, part, read_fields
from clepsydra.process.errors_at import errors_at
from clepsydra.process.known_names import known_names
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.fields import sensor, table_below
from clepsydra.studies.file.law_parameters import check_law_range
from clepsydra.studies.file.written import Written, WrittenMaker


def _pumps(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[Signal, ...]:
    process: Process = known["process"]
    inputs = [signal.name for signal in process.inputs]
    names = known_names(
        inputs,
        table,
        key,
        expected="a list of manipulated variables",
        remedy=f'write as in pumps = ["{inputs[0]}"]',
        each="the name of a manipulated variable",
    )
    return tuple(process.signal(name) for name in names)


def _levels(table: TableReader, key: str, known: Mapping[str, Any]) -> list[float]:
    return _one_for_each(table, key, [known["measured"]] * len(known["pumps"]))


def _moved(table: TableReader, key: str, known: Mapping[str, Any]) -> list[float] | None:
    return _one_for_each(table, key, known["pumps"]) if table.has(key) else None


def _one_for_each(table: TableReader, key: str, signals: Sequence[Signal]) -> list[float]:
    """Return a list of values, one for each pump, each in the range of its signal."""
    remedy = f'write as in {key} = ["1 m", "2 m"], in the unit of what it is of'
    written = table.raw(key) if table.has(key) else None
    if not isinstance(written, list) or len(written) != len(signals):
        raise table.wrong(key, f"a list of {len(signals)} values, one for each pump", remedy)
    return [
        read_in_range(table.with_value(key, value), key, signal, "a value", remedy)
        for value, signal in zip(written, signals, strict=True)
    ]


_NOTE = "It follows no setpoint: the level goes to and fro between start and stop."
_LEVELS = "lists of levels, one for each stage; pumps that fill start below where they stop"
_VALUES = "lists of values, one for each pump, while it runs and stands"


@dataclass(frozen=True)
class StartStop:
    """Start and stop levels [unit of the measurement], and what pumps run with [their units]."""

    measured: Signal = sensor("the sensor of the level", "the sensor of the level")
    pumps: tuple[Signal, ...] = part(
        _pumps, required=(OWN,), **told.names("list of manipulated variables")
    )
    start: list[float] = part(_levels, required=(OWN,), **told.quantities(_LEVELS))
    stop: list[float] = part(_levels, required=(OWN,), **told.quantities(_LEVELS))
    running: list[float] | None = part(_moved, **told.quantities(_VALUES))
    stopped: list[float] | None = part(_moved, **told.quantities(_VALUES))
    alternation: bool = flag(default=True, words="whether the duty pump changes after each run")
    shortest_rest: float = quantity(
        "s",
        "least time from a stop to the next start of a pump",
        at_least=0.0,
        default=0.0,
        remedy="leave it out for none",
    )


@dataclass(frozen=True)
class StartStopTable(Written):
    """Start and stop levels, one of each for every pump; all stand until the level says otherwise.

    Raises
    ------
    InputError
        A name is unknown, there is not one level for each pump, a level is outside its range, or
        the levels do not follow each other.
    """

    start_stop: TableReader = table_below(
        StartStop,
        "pumps that run or stand by a level",
        "write [controllers.NAME.start_stop]",
    )

    def maker(self) -> WrittenMaker:
        """Check the levels against each other and the law."""
        table = self.start_stop
        read = StartStop(**read_fields(StartStop, table, process=self.process))
        measurement, pumps = read.measured.name, tuple(pump.name for pump in read.pumps)
        law = start_stop_law([read.measured], read.pumps)
        values = {parameter.name: parameter.initial for parameter in law.parameters}
        places: dict[str, str] = {}
        for key, levels in (("start", read.start), ("stop", read.stop)):
            names = [path(s, f"{key}_level") for s in owners(law.parameters, f"{key}_level")]
            values |= dict(zip(names, levels, strict=True))
            places |= dict.fromkeys(names, table.place(key))
        for key, moved in (("running", read.running), ("stopped", read.stopped)):
            if moved is not None:
                names = [path(pump, f"{key}_value") for pump in pumps]
                values |= dict(zip(names, moved, strict=True))
        values |= {"alternation": float(read.alternation), "shortest_rest": read.shortest_rest}
        if table.has("shortest_rest"):
            (rest,) = (each for each in law.parameters if each.name == "shortest_rest")
            check_law_range(table, "shortest_rest", rest, values["shortest_rest"])
        with errors_at(table, places):
            check_parameters(law, values, self.name)
            check_levels(law, values, self.name)

        def make(model: LinearModel) -> Controller:
            at = {measurement: operating_point_of(model).as_dict()[measurement]}
            at |= {pump: values[path(pump, "stopped_value")] for pump in pumps}
            return Controller(
                name=self.name,
                family=FAMILY,
                structure=Complexity.LOOPS,
                design=f"Written out: {', '.join(pumps)} by start and stop levels of "
                f"{measurement}.",
                law=law,
                values=values,
                initial_state=state_at_rest(law, values, at),
                measurements=(measurement,),
                setpoints=(),
                manipulated=pumps,
                notes=(_NOTE,),
            )

        return make
