"""Start and stop levels of pumps, written out in a study file."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import check_parameters
from clepsydra.controllers.signals import owners
from clepsydra.controllers.start_stop_levels import FAMILY, start_stop_law
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.names_among import names_among
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.gains import check_in_range, read_value
from clepsydra.studies.file.law_range import check_law_range
from clepsydra.studies.file.placed import placed

START_STOP_KEYS = (
    "measurement",
    "pumps",
    "start",
    "stop",
    "alternation",
    "shortest_rest",
    "running",
    "stopped",
)


@dataclass(frozen=True, eq=False)
class StartStop:
    """A law of start and stop levels with its numbers.

    Parameters
    ----------
    name : str
    law : StepLaw
    values : dict
    measurement : str
    pumps : tuple of str

    Examples
    --------
    See `read_start_stop`.
    """

    name: str
    law: StepLaw
    values: dict[str, float]
    measurement: str
    pumps: tuple[str, ...]

    def controller(self, point: OperatingPoint) -> Controller:
        """Return the controller; all pumps stand until the level says otherwise."""
        at = point.as_dict()
        resting = {
            path(pump, "tracking"): self.values[path(pump, "stopped_value")] for pump in self.pumps
        }
        inputs = {path(self.measurement, "pv"): at[self.measurement], **resting}
        return Controller(
            name=self.name,
            family=FAMILY,
            design=f"Written out: {', '.join(self.pumps)} by start and stop levels of "
            f"{self.measurement}.",
            law=self.law,
            values=self.values,
            initial_state=state_at_rest(self.law, self.values, inputs),
            measurements=(self.measurement,),
            setpoints=(),
            manipulated=self.pumps,
            notes=("It follows no setpoint: the level goes to and fro between start and stop.",),
        )


def read_start_stop(table: TableReader, name: str, process: Process) -> StartStop:
    """Read start and stop levels, one of each for every pump.

    Parameters
    ----------
    table : TableReader
        With `START_STOP_KEYS`.
    name : str
        Of the controller.
    process : Process

    Raises
    ------
    InputError
        A name is unknown, there is not one level for each pump, a level is outside its range, or
        the levels do not follow each other.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b'''measurement = "level"
    ... pumps = ["duty", "standby"]
    ... start = ["10 mA", "13 mA"]
    ... stop = ["7 mA", "9 mA"]
    ... '''
    >>> table = TableReader(parse(text, "study.toml"), (), START_STOP_KEYS)
    >>> found = read_start_stop(table, "pumps", load_process("wet-well:start-stop"))
    >>> found.values["stage.2.start_level"], found.values["duty.running_value"]
    (0.013, 1.0)
    """
    sensors = {signal.name: signal for signal in process.measurements}
    inputs = [signal.name for signal in process.inputs]
    remedy = f'write as in measurement = "{next(iter(sensors))}"'
    measurement = table.text("measurement", "the sensor of the level", remedy)
    (measured_by,) = names_among(
        list(sensors),
        table.with_value("measurement", [measurement]),
        "measurement",
        expected="the sensor of the level",
        remedy=remedy,
        each="the name of a sensor",
    )
    measured = sensors[measured_by]
    pumps = names_among(
        inputs,
        table,
        "pumps",
        expected="a list of manipulated variables",
        remedy=f'write as in pumps = ["{inputs[0]}"]',
        each="the name of a manipulated variable",
    )
    driven = [process.signal(pump) for pump in pumps]
    law = start_stop_law([measured], driven)
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    places: dict[str, str] = {}
    written: list[list[float]] = []
    for key, parameter in (("start", "start_level"), ("stop", "stop_level")):
        levels = _one_for_each(table, key, pumps, [measured] * len(pumps))
        names = [path(stage, parameter) for stage in owners(law.parameters, parameter)]
        values |= dict(zip(names, levels, strict=True))
        places |= dict.fromkeys(names, table.place(key))
        written.append(levels)
    _check_levels(table, *written)
    for key in ("running", "stopped"):
        if table.has(key):
            moved = _one_for_each(table, key, pumps, driven)
            values |= {
                path(pump, f"{key}_value"): value for pump, value in zip(pumps, moved, strict=True)
            }
    values["alternation"] = float(table.flag("alternation", default=True))
    values["shortest_rest"] = table.quantity(
        "shortest_rest", "s", "a time", "leave it out for none", at_least=0.0, default=0.0
    )
    if table.has("shortest_rest"):
        (rest,) = (each for each in law.parameters if each.name == "shortest_rest")
        check_law_range(table, "shortest_rest", rest, values["shortest_rest"])
    with placed(table, places):
        check_parameters(law, values, name)
    return StartStop(name, law, values, measured.name, pumps)


def _check_levels(table: TableReader, start: list[float], stop: list[float]) -> None:
    """Refuse what `start_stop_levels.check_levels` does, in the words of the file."""
    starts, stops = table.raw("start"), table.raw("stop")
    assert isinstance(starts, list) and isinstance(stops, list)
    side = "above" if start[0] >= stop[0] else "below"
    sign = 1.0 if side == "above" else -1.0
    for j in range(len(start)):
        if not sign * (start[j] - stop[j]) > 0.0:
            raise table.refused(
                "start",
                shown_value(starts[j]),
                f"a start of stage {j + 1} {side} its stop at {stops[j]}",
                "let every stage start on the same side of where it stops",
            )
        if j and not sign * (start[j] - start[j - 1]) > 0.0:
            raise table.refused(
                "start",
                shown_value(starts[j]),
                f"a start of stage {j + 1} {side} that of stage {j} at {starts[j - 1]}",
                "let each stage start after the one before it",
            )


def _one_for_each(
    table: TableReader, key: str, pumps: tuple[str, ...], signals: list[Signal]
) -> list[float]:
    """Return a list of values, one for each pump, each in the range of its signal."""
    remedy = f'write as in {key} = ["1 m", "2 m"], in the unit of what it is of'
    written = table.raw(key) if table.has(key) else None
    if not isinstance(written, list) or len(written) != len(pumps):
        shown = f"no {key}" if written is None else shown_value(written)
        raise table.refused(key, shown, f"a list of {len(pumps)} values, one for each pump", remedy)
    found = []
    for number, signal in enumerate(signals):
        entry = table.with_value(key, written[number])
        value = read_value(entry, key, signal, "a value", remedy)
        check_in_range(entry, key, signal, value, "a value")
        found.append(value)
    return found
