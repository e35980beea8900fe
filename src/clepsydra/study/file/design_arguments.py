"""The arguments of a design, read from the keys of a study file."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, get_args

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.multiloop_pid import Decoupling
from clepsydra.controllers.pid_form import Actions, Algorithm, DerivativeOn, PidForm
from clepsydra.design.states.quadratic_weights import QuadraticWeights, diagonal_weights
from clepsydra.design.states.relevant_states import without_idle_states
from clepsydra.design.ziegler_nichols import Experiment
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.names_among import names_among
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.study.file.gains import read_value
from clepsydra.study.file.placed import placed

#: An argument that is known only with the model.
OfModel = Callable[[LinearModel], Any]
_COMPLEX = re.compile(r"[-+0-9.eEj ]{1,60}")


def design_keys(design: Callable[..., Controller]) -> tuple[str, ...]:
    """Return the keys that a design has in a study file.

    A form of PID controller stands there by its own keys, and the model is not asked for.

    Examples
    --------
    >>> from clepsydra.design.amigo import design_amigo
    >>> design_keys(design_amigo)
    ('pairing', 'actions', 'algorithm', 'derivative_on', 'anti_windup', 'as_published')
    """
    names = list(inspect.signature(design).parameters)[1:]
    return tuple(key for name in names for key in (_FORM if name == "form" else (name,)))


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

    Raises
    ------
    InputError
        A value is none of its argument, or an argument without a default is missing.

    Examples
    --------
    >>> from clepsydra.design.simc import design_simc
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
            raise table.refused(name, f"no {name}", "what this design is made from", f"add {name}")
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


def _per_hour(table: TableReader, key: str, process: Process) -> float:
    unit = "1" if not isinstance(table.raw(key), str) else "1/h"
    return table.quantity(key, unit, "a number of starts", 'write as in 6 or "6 1/h"', above=0.0)


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
        'write as in weights = { states = { "tank_1.level" = 4.0 }, inputs = { pump_1 = 0.2 } }'
    )
    rows = table.table(key, "weights", remedy, ("states", "inputs", "integrals"))
    read = {
        what: _numbers(rows.table(what, f"{what} with their weights", remedy))
        for what in ("states", "inputs", "integrals")
        if what != "integrals" or rows.has(what)
    }

    def weights(model: LinearModel) -> QuadraticWeights:
        wanted = read["states"].keys() <= set(without_idle_states(model).states)
        fitting = without_idle_states(model) if wanted else model
        with placed(rows):
            return diagonal_weights(fitting, read["states"], read["inputs"], read.get("integrals"))

    return OfModelArgument(weights)


def _numbers(table: TableReader) -> dict[str, float]:
    return {
        name: table.quantity(name, "1", "a weight", "give a number", at_least=0.0)
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
_rate = partial(_quantity, unit="rad/s", expected="a frequency", example="0.01 rad/s")
#: How each argument of a design is read.
READERS: dict[str, Callable[[TableReader, str, Process], Any]] = {
    "pairing": _pairing,
    "closed_loop_time_constant": _time,
    "arrest_time": _time,
    "deviation": _deviation,
    "phase_margin": partial(_quantity, unit="rad", expected="an angle", example="60 deg"),
    "crossover": _rate,
    "bandwidth": _rate,
    "as_published": _flag,
    "experiment": partial(_word, words=get_args(Experiment)),
    "maximum_errors": partial(_deviations, of="outputs"),
    "maximum_moves": partial(_deviations, of="inputs"),
    "anti_windup": partial(_word, words=get_args(AntiWindup)),
    "measurements": _measurements,
    "weights": _weights,
    "starts_per_hour": _per_hour,
    "decoupling": partial(_word, words=get_args(Decoupling)),
    "poles": _poles,
    "observer_poles": _poles,
}
