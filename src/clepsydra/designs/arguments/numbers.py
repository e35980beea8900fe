"""Arguments that are lists of numbers: poles, roots, rates."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.designs.arguments.argument import Argument, argument, number

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

_COMPLEX = re.compile(r"[-+0-9.eEj ]{1,60}")


def poles(name: str, words: str) -> Argument:
    """Return an argument that is a list of poles of a sampled loop, complex ones as text."""
    schema = {"type": "array", "items": {"type": ["string", "number"]}, "minItems": 1}
    return argument(name, _poles, words, schema)


def _poles(table: TableReader, key: str, process: Process) -> list[complex]:
    """Read poles of the sampled loop: numbers, or text such as "0.9 + 0.1j"."""
    remedy = 'write as in [0.97, "0.9+0.05j", "0.9-0.05j"], z = e^(sT) each'
    written = table.raw(key)
    if not isinstance(written, list) or not written:
        raise table.wrong(key, "a list of poles", remedy)
    found: list[complex] = []
    for entry in written:
        try:
            if isinstance(entry, bool) or not _COMPLEX.fullmatch(str(entry)):
                raise ValueError(entry)
            pole = complex(str(entry).replace(" ", ""))
        except ValueError:
            shown = table.with_value(key, entry).written(key)
            raise table.refused(key, shown, "a pole", remedy) from None
        found.append(pole)
    return [pole.real if pole.imag == 0.0 else pole for pole in found]


def _real_numbers(table: TableReader, key: str, process: Process) -> list[float]:
    written = table.raw(key)
    entries: list[Any] = written if isinstance(written, list) else [written]
    if not entries or any(type(entry) not in (int, float) for entry in entries):
        raise table.wrong(key, "a list of numbers", "write as in [0.5]")
    return [float(entry) for entry in entries]


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
    entries, remedy = [table.with_value(key, each) for each in written], f"write as in [{example}]"
    return [entry.quantity(key, unit, "a rate", remedy, above=0.0) for entry in entries]


def _check_assigned(poles: Sequence[float]) -> None:
    for pole in poles:
        if not is_finite_number(pole) or not 0.0 <= pole < 1.0:
            expected = "real poles from 0 to below 1"
            raise InputError("assigned_poles", pole, expected, "a smaller one is faster")


ASSIGNED_POLES = argument(
    "assigned_poles",
    _real_numbers,
    "list of poles beside those that `penalty` gives",
    {"type": ["array", "number"], "items": {"type": "number"}, "minItems": 1},
    "",
    _check_assigned,
)
ALPHA = argument(
    "alpha",
    _rates,
    'rate at which a saturated integral is led back, `"0.1 1/s"` or a list; plain SI numbers where '
    'it is on the `"input"`',
    {"type": ["string", "number", "array"], "items": {"type": ["string", "number"]}},
    "quantity",
)
PENALTY = number(
    "penalty", "a penalty of the input", "q_u, the weight of the input's square", example="1.0"
)
