"""Fields of what a study file writes out: files, tables, signals, and quantities of these."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.standing import Standing, standing_at
from clepsydra.process import told
from clepsydra.process.declared import OWN, Part, keys_of, part, table_schema
from clepsydra.process.gains import read_gain
from clepsydra.process.known_names import known_name
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader

#: From what is moved and what is measured to the gain between them [SI units of both].
Gain = Callable[[Signal, Signal], float]
#: From a signal to a value in its range [its unit].
Value = Callable[[Signal], float]


def sensor(words: str, expected: str = "the sensor that it reads") -> Any:
    """Return the field of the signal that the key `measurement` names."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> Signal:
        process, key = known["process"], "measurement"
        signals = {signal.name: signal for signal in process.measurements}
        name = table.text(key, expected, f'write as in measurement = "{next(iter(signals))}"')
        return signals[known_name(table, key, name, signals, f"a sensor of {process.name}")]

    return part(read, {"measurement": told.text(words)}, required=("measurement",))


def file_beside(
    words: str,
    expected: str,
    remedy: str,
    load: Callable[[Path], Any],
    *,
    ending: str = "",
    told_at_key: bool = False,
) -> Any:
    """Return the field of what is loaded from a file, whose path starts beside the study file.

    What is wrong within the file is told with its place there, after that of the key if wanted.
    """

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> Any:
        written, folder = table.text(key, expected, remedy), known["folder"]
        wanted, place = f"{expected} that exists, from {folder}/", table.place(key)
        standing = standing_at(folder / written, place, wanted, "check the path", written[:60])
        if not written.endswith(ending) or standing is not Standing.FILE:
            raise table.refused(key, written[:60], wanted, remedy)
        try:
            return load(folder / written)
        except InputError as error:
            place = f"{table.place(key)}, {error.place}" if told_at_key else error.place
            raise InputError(place, error.value, error.expected, error.remedy) from None

    return part(read, required=(OWN,), **told.text(words))


def table_below(kind: type, words: str, remedy: str) -> Any:
    """Return the field of a table with the keys of a class; None where it is not written."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> TableReader | None:
        return table.table(key, "a table", remedy, keys_of(kind)) if table.has(key) else None

    made = Part(read, schema={"description": words, **table_schema(kind)})
    return field(metadata={"declared": made})


def moved(words: str = "what it moves, as of a loop") -> Any:
    """Return the field of the name of what is moved."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
        remedy = f'write the name of one, as in output = "{known["process"].inputs[0].name}"'
        return table.text(key, "what it moves", remedy)

    return part(read, required=(OWN,), **told.text(words))


def gain_between(words: str, expected: str, remedy: str, *, required: bool = False) -> Any:
    """Return the field of a `Gain`, which is read once its signals are known."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> Gain:
        return lambda moved, measured: read_gain(
            table,
            key,
            moved,
            measured,
            expected=expected,
            remedy=remedy.format(moved=moved.name, measured=measured.name),
        )

    return part(read, required=(OWN,) if required else (), **told.quantity(words))


def value_in_range(words: str, expected: str, remedy: str, *, required: bool = False) -> Any:
    """Return the field of a `Value`, which is read once its signal is known."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> Value | None:
        if not required and not table.has(key):
            return None
        return lambda signal: read_in_range(
            table, key, signal, expected, remedy.format(signal=signal.name)
        )

    return part(read, required=(OWN,) if required else (), **told.quantity(words))
