"""The arguments of a design, read from the keys of a study file."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, get_args

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import split_quantity
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import Decoupling
from clepsydra.controllers.pid_form import Actions, Algorithm, DerivativeOn, PidForm
from clepsydra.controllers.virtual_input import AlphaOn
from clepsydra.designs.operating_plan import Follows
from clepsydra.designs.smith_predictor import Primary
from clepsydra.designs.states.quadratic_weights import QuadraticWeights, diagonal_weights
from clepsydra.designs.states.relevant_states import without_idle_states
from clepsydra.designs.ziegler_nichols import Experiment
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.names_among import names_among
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.studies.file.gains import read_value
from clepsydra.studies.file.placed import placed

#: An argument that is known only with the model.
OfModel = Callable[[LinearModel], Any]
_WEIGHED = ("states", "inputs", "integrals")
_ANGLES = ("deg", "degree", "degrees", "°", "rad", "radian", "radians")
_COMPLEX = re.compile(r"[-+0-9.eEj ]{1,60}")


def design_keys(design: Callable[..., Controller]) -> tuple[str, ...]:
    """Return the keys that a design has in a study file.

    A form of PID controller stands there by its own keys, and the model is not asked for. What
    only a program can give, a controller or a sampled model, has no key.

    Examples
    --------
    >>> from clepsydra.designs.amigo import design_amigo
    >>> design_keys(design_amigo)
    ('pairing', 'actions', 'algorithm', 'derivative_on', 'anti_windup', 'as_published')
    """
    names = list(inspect.signature(design).parameters)[1:]
    known = [name for name in names if name == "form" or name in READERS]
    return tuple(key for name in known for key in (_FORM if name == "form" else (name,)))


def read_arguments(
    table: TableReader, design: Callable[..., Controller], process: Process
) -> dict[str, Any]:
    """Return the keyword arguments of a design that a table gives.

    Parameters
    ----------
    table : TableReader
        Its keys have been checked against `design_keys`.
    design : callable
    process : Process

    Returns
    -------
    dict
        An argument that needs the model is a function of it, wrapped in `OfModelArgument`.
        A pairing that is left out is that of the analysis, and missing here.

    Raises
    ------
    InputError
        A value is none of its argument, or an argument without a default is missing.

    Examples
    --------
    >>> from clepsydra.designs.simc import design_simc
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> text = b"closed_loop_time_constant = '5 min'\\nalgorithm = 'series'"
    >>> table = TableReader(parse(text, "study.toml"), (), None)
    >>> found = read_arguments(table, design_simc, load_process("equalisation-tank"))
    >>> found["form"].algorithm, found["closed_loop_time_constant"]
    ('series', 300.0)
    """
    found: dict[str, Any] = {}
    for name, parameter in list(inspect.signature(design).parameters.items())[1:]:
        if name == "form":
            if any(table.has(key) for key in _FORM):
                found[name] = _form(table)
        elif table.has(name):
            found[name] = READERS[name](table, name, process)
        elif parameter.default is parameter.empty and name != "pairing":
            READERS[name](table, name, process)  # says what is missing
    return found


def with_model(arguments: Mapping[str, Any], model: LinearModel) -> dict[str, Any]:
    """Return the arguments of a design for a model.

    Examples
    --------
    >>> with_model({"arrest_time": 60.0}, None)
    {'arrest_time': 60.0}
    """
    return {
        name: value.of(model) if isinstance(value, OfModelArgument) else value
        for name, value in arguments.items()
    }


class OfModelArgument:
    """An argument that is known only with the model.

    Examples
    --------
    >>> OfModelArgument(lambda model: 2).of(None)
    2
    """

    def __init__(self, of: OfModel) -> None:
        self.of = of


def _form(table: TableReader) -> PidForm:
    chosen = {
        key: _word(table, key, None, words=words) for key, words in _FORM.items() if table.has(key)
    }
    with placed(table):
        return PidForm(**chosen)


def _quantity(
    table: TableReader, key: str, process: Process, *, unit: str, expected: str, example: str
) -> float:
    return table.quantity(key, unit, expected, f'write as in "{example}"', above=0.0)


def _word(table: TableReader, key: str, process: Process | None, *, words: tuple[str, ...]) -> Any:
    return table.choice(key, words, words[0])


def _number(
    table: TableReader, key: str, process: Process, *, expected: str, example: str, above: float
) -> float:
    return table.quantity(key, "1", expected, f"write as in {example}", above=above)


def _whole(table: TableReader, key: str, process: Process) -> int:
    written = table.raw(key)
    if isinstance(written, bool) or not isinstance(written, int) or written < 1:
        raise table.refused(key, shown_value(written), "a whole number from 1", "write as in 6")
    return written


def _per_hour(table: TableReader, key: str, process: Process) -> float:
    unit = "1" if not isinstance(table.raw(key), str) else "1/h"
    return table.quantity(key, unit, "a number of starts", 'write as in 6 or "6 1/h"', above=0.0)


def _angle(table: TableReader, key: str, process: Process) -> float:
    """Read an angle above zero and below half a turn [rad]."""
    remedy = 'write as in "60 deg"'
    parts = split_quantity(table.raw(key))
    # Any share would be taken for radians: 60 % of them are 34 deg.
    if parts is None or parts[1] not in _ANGLES:
        raise table.refused(key, table.written(key), "an angle in deg or rad", remedy)
    degrees = table.quantity(key, "deg", "an angle", remedy, above=0.0)
    if not degrees < 180.0:
        raise table.refused(key, table.written(key), "an angle below 180 deg", remedy)
    return math.radians(degrees)


def _rate(table: TableReader, key: str, process: Process) -> float:
    """Read an angular frequency above zero [rad/s]."""
    remedy = 'write as in "0.01 rad/s"'
    parts = split_quantity(table.raw(key))
    # Units of an angle are numbers, so that a hertz would be taken for one radian a second.
    if parts is not None and re.search("hz|hertz", parts[1], re.IGNORECASE):
        raise table.refused(
            key,
            table.written(key),
            "an angular frequency in rad/s",
            "multiply hertz by 2 pi, which is 6.283",
        )
    return table.quantity(key, "rad/s", "a frequency", remedy, above=0.0)


def _flag(table: TableReader, key: str, process: Process) -> bool:
    return table.flag(key, default=False)


def _pairing(table: TableReader, key: str, process: Process) -> tuple[tuple[str, str], ...]:
    """Read which input moves which controlled measurement."""
    remedy = f'write as in pairing = {{ {process.controlled[0]} = "{process.inputs[0].name}" }}'
    inputs = [signal.name for signal in process.inputs]
    rows = table.table(key, "controlled measurements, each with its input", remedy)
    pairs: list[tuple[str, str]] = []
    for output in rows.present:
        _known(
            rows, output, output, process.controlled, f"a controlled measurement of {process.name}"
        )
        moved = rows.name(output, "the name of an input")
        _known(rows, output, moved, inputs, f"an input of {process.name}")
        for other, taken in pairs:
            if taken == moved:
                raise rows.refused(
                    output,
                    moved,
                    f"an input of its own: {moved} moves {other} already",
                    "pair each input once",
                )
        pairs.append((output, moved))
    if not pairs:
        raise table.refused(key, "no pair", "at least one pair", remedy)
    return tuple(pairs)


def _deviations(table: TableReader, key: str, process: Process, *, of: str) -> dict[str, float]:
    """Read a largest deviation of some signals [their units]."""
    known = process.controlled if of == "outputs" else [u.name for u in process.inputs]
    words = "a controlled measurement" if of == "outputs" else "an input"
    remedy = f'write as in {{ {known[0]} = "10 %" }}'
    rows = table.table(key, "signals with their largest deviation", remedy)
    found = {}
    for name in rows.present:
        _known(rows, name, name, known, f"{words} of {process.name}")
        found[name] = _positive(rows, name, process.signal(name), remedy)
    return found


def _deviation(table: TableReader, key: str, process: Process) -> float:
    """Read one deviation for all controlled measurements, which must have one unit."""
    signals = [process.signal(name) for name in process.controlled]
    if len({(signal.unit, signal.low, signal.high) for signal in signals}) > 1:
        raise table.refused(
            key,
            table.written(key),
            f"no one {key} for {', '.join(process.controlled)}, which differ in unit or range",
            "leave it out, or give a time instead",
        )
    return _positive(table, key, signals[0], 'write as in "20 %" of the range')


def _positive(table: TableReader, key: str, signal: Signal, remedy: str) -> float:
    value = read_value(table, key, signal, "a deviation", remedy, change=True)
    if not value > 0.0:
        raise table.refused(key, table.written(key), "a deviation above 0", remedy)
    return value


def _measurements(table: TableReader, key: str, process: Process) -> tuple[str, ...]:
    known = [signal.name for signal in process.measurements]
    return names_among(
        known,
        table,
        key,
        expected="a list of sensors",
        remedy=f'write as in ["{known[0]}"]',
        each="the name of a sensor",
    )


def _weights(table: TableReader, key: str, process: Process) -> OfModelArgument:
    """Read the weights of squares of states, inputs and integrals [1 / SI unit squared]."""
    remedy = (
        f'write as in weights = {{ states = {{ "{process.state[0].name}" = 4.0 }}, '
        f"inputs = {{ {process.inputs[0].name} = 0.2 }} }}"
    )
    expected = "weights of states and inputs, for LQI of integrals as well"
    rows = table.table(key, expected, remedy, _WEIGHED)
    read = {
        what: _weight_numbers(
            rows.table(what, f"{what} with their weights", remedy), what != "states"
        )
        for what in _WEIGHED
        if what != "integrals" or rows.has(what)
    }

    def weights(model: LinearModel) -> QuadraticWeights:
        wanted = read["states"].keys() <= set(without_idle_states(model).states)
        fitting = without_idle_states(model) if wanted else model
        with placed(rows):
            return diagonal_weights(fitting, read["states"], read["inputs"], read.get("integrals"))

    return OfModelArgument(weights)


def _weight_numbers(table: TableReader, positive: bool) -> dict[str, float]:
    bound = {"above" if positive else "at_least": 0.0}
    return {
        name: table.quantity(name, "1", "a weight", "correct the number", **bound)
        for name in table.present
    }


def _poles(table: TableReader, key: str, process: Process) -> list[complex]:
    """Read poles of the sampled loop: numbers, or text such as "0.9 + 0.1j"."""
    remedy = 'write as in [0.97, "0.9+0.05j", "0.9-0.05j"], z = e^(sT) each'
    written = table.raw(key)
    if not isinstance(written, list) or not written:
        raise table.refused(key, shown_value(written), "a list of poles", remedy)
    found: list[complex] = []
    for entry in written:
        try:
            if isinstance(entry, bool) or not _COMPLEX.fullmatch(str(entry)):
                raise ValueError(entry)
            pole = complex(str(entry).replace(" ", ""))
        except ValueError:
            raise table.refused(key, shown_value(entry), "a pole", remedy) from None
        found.append(pole)
    return [pole.real if pole.imag == 0.0 else pole for pole in found]


def _numbers(table: TableReader, key: str, process: Process) -> list[float]:
    written = table.raw(key)
    entries: list[Any] = written if isinstance(written, list) else [written]
    if not entries or not all(
        isinstance(entry, (int, float)) and not isinstance(entry, bool) for entry in entries
    ):
        raise table.refused(key, shown_value(written), "a list of numbers", "write as in [0.5]")
    return [float(entry) for entry in entries]


def _measurement(table: TableReader, key: str, process: Process) -> str:
    """Read the name of a controlled measurement."""
    name = table.text(key, "a controlled measurement", f'write as in "{process.controlled[0]}"')
    _known(table, key, name, process.controlled, f"a controlled measurement of {process.name}")
    return name


def _points(table: TableReader, key: str, process: Process) -> list[float]:
    """Read the operating points of a schedule, quantities of the measurement that it is over."""
    over = _measurement(table, "over", process)
    signal = process.signal(over)
    remedy = f'write as in ["10 {signal.shown_unit}"]'
    written = table.raw(key)
    if not isinstance(written, list) or not written:
        raise table.refused(key, shown_value(written), f"a list of values of {over}", remedy)
    return [
        read_value(table.with_value(key, entry), key, signal, "a value", remedy)
        for entry in written
    ]


def _rates(table: TableReader, key: str, process: Process) -> float | list[float]:
    """Read rates above zero, one for all loops or a list: [1/s], or plain where α is on the input.

    On the input its unit is that of the output's r-th derivative per unit of the input and second,
    another for each loop.
    """
    on_input = table.has("alpha_on") and table.raw("alpha_on") == "input"
    unit, example = ("1", "0.1") if on_input else ("1/s", '"0.1 1/s"')
    written = table.raw(key)
    if not isinstance(written, list):
        return table.quantity(key, unit, "a rate", f"write as in {example}", above=0.0)
    return [
        table.with_value(key, entry).quantity(
            key, unit, "a rate", f"write as in [{example}]", above=0.0
        )
        for entry in written
    ]


def _known(table: TableReader, key: str, name: str, known: Iterable[str], words: str) -> None:
    names = list(known)
    if name not in names:
        raise table.refused(
            key,
            name[:60],
            f"{words} ({', '.join(names)})",
            suggestion(name, names, "choose one of them"),
        )


_FORM: dict[str, tuple[str, ...]] = {
    "actions": get_args(Actions),
    "algorithm": get_args(Algorithm),
    "derivative_on": get_args(DerivativeOn),
    "anti_windup": get_args(AntiWindup),
}
_time = partial(_quantity, unit="s", expected="a time", example="5 min")
#: How each argument of a design is read.
READERS: dict[str, Callable[[TableReader, str, Process], Any]] = {
    "pairing": _pairing,
    "closed_loop_time_constant": _time,
    "arrest_time": _time,
    "deviation": _deviation,
    "phase_margin": _angle,
    "crossover": _rate,
    "bandwidth": _rate,
    "as_published": _flag,
    "experiment": partial(_word, words=get_args(Experiment)),
    "maximum_errors": partial(_deviations, of="outputs"),
    "maximum_moves": partial(_deviations, of="inputs"),
    "anti_windup": partial(_word, words=(*get_args(AntiWindup), "variable_structure")),
    "measurements": _measurements,
    "weights": _weights,
    "starts_per_hour": _per_hour,
    "decoupling": partial(_word, words=get_args(Decoupling)),
    "poles": _poles,
    "observer_poles": _poles,
    "over": _measurement,
    "follows": partial(_word, words=get_args(Follows)),
    "points": _points,
    "steps": _whole,
    "relaxation": partial(_number, expected="a factor", example="1.1", above=1.0),
    "order": _whole,
    "penalty": partial(_number, expected="a penalty of the input", example="1.0", above=0.0),
    "assigned_poles": _numbers,
    "primary": partial(_word, words=get_args(Primary)),
    "alpha": _rates,
    "alpha_on": partial(_word, words=get_args(AlphaOn)),
    "despite_unstable_internal_dynamics": _flag,
    "largest_error": partial(_number, expected="a share of the range", example="0.5", above=0.0),
}
