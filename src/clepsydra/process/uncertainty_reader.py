"""The table [uncertainty] of a process file, or the same as a mapping from Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import split_quantity, to_si
from clepsydra.process import told
from clepsydra.process.equations import Equations
from clepsydra.process.known_names import known_names
from clepsydra.process.rule_reader import KEYS, RULE, read_rule
from clepsydra.process.signal_values import check_unit
from clepsydra.process.spread import Correlated, Spread
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.process.uncertainty import Rule, Uncertainty

_DEFAULT, _CORRELATED = "default", "correlated"
#: What an editor is told of the key `uncertainty`.
UNCERTAINTY: told.Schema = {
    "description": "how far the parameters may be from their values",
    "type": "object",
    "properties": {
        _DEFAULT: {"description": "of every parameter that is not named", **RULE},
        _CORRELATED: told.listed(
            "parameters that are high or low together",
            told.table(
                {
                    "parameters": told.names("which"),
                    "correlation": {"description": "one number for all pairs, or a matrix"},
                },
                ("parameters", "correlation"),
            ),
        ),
    },
    # A parameter, or a table of those of an element.
    "additionalProperties": {"anyOf": [told.QUANTITY, {"type": "object"}]},
}


def read_uncertainty(table: TableReader, plant: Equations) -> Uncertainty:
    """Read how uncertain the parameters of a plant are.

    Parameters
    ----------
    table : TableReader
        With any keys.
    plant : Equations
        Whose parameters and disturbances they name.

    Raises
    ------
    InputError
        There is no such parameter, or it cannot be distributed so.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> text = b"default = '0 %'\\ntank_1.area = '5 %'\\npump_2.gain = { same_as = 'tank_1.area' }"
    >>> found = read_uncertainty(TableReader(parse(text, "plant.toml"), (), None), process)
    >>> found.about(process).factors
    (('tank_1.area', 'pump_2.gain'),)
    """
    default = Uncertainty().default
    if table.has(_DEFAULT):
        default = replace(read_rule(table, _DEFAULT, None), shared=True, clipped=True)
    reader = _Names(plant)
    reader.read(table, "")
    found = Uncertainty(default, reader.rules())
    _check_others(found, reader.known)
    spread = found.about(plant)
    return replace(found, correlated=_read_correlated(table, spread))


class _Names:
    """Which rule each name has, whether it is written as one key or as tables in tables."""

    def __init__(self, plant: Equations) -> None:
        self.parameters = {each.name: each for each in plant.parameters}
        self.known = {**self.parameters, **{each.name: each for each in plant.disturbances}}
        self.own: dict[str, Rule] = {}
        self.of_elements: dict[str, Rule] = {}

    def read(self, table: TableReader, above: str) -> None:
        """Read the keys of a table that stands below the names above."""
        for key in table.present:
            if not above and key in (_DEFAULT, _CORRELATED):
                continue
            name = f"{above}.{key}" if above else key
            value = table.raw(key)
            if isinstance(value, Mapping) and self._is_owner(name, value):
                self.read(table.table(key, "a table", "write it as one"), name)
            elif name in self.own or name in self.of_elements:
                raise table.refused(key, name, "every name once", "remove one of the two")
            elif name in self.known:
                self.own[name] = read_rule(table, key, self.known[name])
            elif self._within(name):
                self.of_elements[name] = replace(read_rule(table, key, None), shared=True)
            else:
                self._refuse(table, key, name, value)

    def rules(self) -> dict[str, Rule]:
        """Return the rule of each parameter: its own, before that of its element."""
        shared = {
            parameter: rule
            for name, rule in self.of_elements.items()
            for parameter in self._within(name)
        }
        return shared | self.own

    def _within(self, name: str) -> list[str]:
        return [each for each in self.parameters if each.startswith(f"{name}.")]

    def _is_owner(self, name: str, value: Mapping[str, Any]) -> bool:
        """Return whether what a table has are names below this one, and no distribution."""
        below = [f"{name}.{key}" for key in value]
        if any(each in self.known or self._within(each) for each in below):
            return True
        return bool(self._within(name)) and not any(key in KEYS for key in value)

    def _refuse(self, table: TableReader, key: str, name: str, value: object) -> None:
        if isinstance(value, Mapping):
            name = ".".join((name, *(each for each in [*value][:1] if each not in KEYS)))
        elements = dict.fromkeys(each.owner for each in self.parameters.values() if each.owner)
        known = [*self.known, *elements]
        expected = "the name of a parameter, an element with parameters, or a disturbance"
        remedy = suggestion(name, known, f"choose from {', '.join(known)}")
        raise table.refused(key, name[:60], expected, remedy)


def _check_others(found: Uncertainty, known: Mapping[str, Signal]) -> None:
    """Refuse a parameter that varies as one that there is not, or at last as itself."""
    for name, rule in found.named.items():
        passed = [name]
        while rule.other:
            if rule.other not in known:
                remedy = suggestion(rule.other, known, f"choose from {', '.join(known)}")
                expected = "the name of a parameter or a disturbance"
                raise InputError(rule.place, rule.other[:60], expected, remedy)
            passed.append(rule.other)
            if rule.other in passed[:-1]:
                expected = "one of them with a distribution of its own"
                remedy = "let one of them vary by itself"
                raise InputError(rule.place, " → ".join(passed), expected, remedy)
            rule = found.named.get(rule.other, found.default)


def _read_correlated(table: TableReader, spread: Spread) -> tuple[Correlated, ...]:
    remedy = "write [[uncertainty.correlated]] with parameters and correlation"
    expected = "a list of tables"
    taken: set[str] = set()
    found = []
    for each in table.tables(_CORRELATED, expected, remedy, ("parameters", "correlation")):
        names = known_names(
            spread.streams,
            each,
            "parameters",
            expected="a list of parameters",
            remedy=f"write as in parameters = {shown_value([*spread.streams[:2]])}",
            each="a parameter that varies by itself",
        )
        if len(names) < 2:
            raise each.wrong("parameters", "at least two parameters", "name another one")
        for name in names:
            if name in taken:
                expected = "every parameter in one list at most"
                remedy = "join the two lists, with a matrix"
                raise each.refused("parameters", name, expected, remedy)
        taken |= {*names}
        found.append(Correlated(names, _matrix(each, len(names))))
    return tuple(found)


def _matrix(table: TableReader, size: int) -> tuple[tuple[float, ...], ...]:
    key, example = "correlation", "write as in correlation = 0.8"
    value = table.raw(key) if table.has(key) else None
    if isinstance(value, (list, tuple)):
        expected = f"a matrix of {size} rows with {size} numbers each"
        if len(value) != size or not all(
            isinstance(row, (list, tuple)) and len(row) == size for row in value
        ):
            raise table.wrong(key, expected, "write a row and a column for each parameter")
        matrix = np.array([[_correlation(table, key, each) for each in row] for row in value])
        if not (np.array_equal(matrix, matrix.T) and np.all(np.diag(matrix) == 1.0)):
            expected = "a symmetric matrix with 1 on its diagonal"
            raise table.wrong(key, expected, "correct it")
    elif value is None:
        raise table.wrong(key, "a number from -1 to 1, or a matrix", example)
    else:
        matrix = np.full((size, size), _correlation(table, key, value))
        np.fill_diagonal(matrix, 1.0)
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        expected = "a positive definite matrix, or parameters contradict each other"
        remedy = "make numbers off the diagonal smaller"
        raise table.wrong(key, expected, remedy) from None
    return tuple(tuple(row) for row in matrix.tolist())


def _correlation(table: TableReader, key: str, value: object) -> float:
    parts = split_quantity(value)
    one = table.with_value(key, value)
    expected, example = "a number from -1 to 1", "0.8"
    if parts is not None or isinstance(value, str):
        check_unit(one, key, "1", expected, example, "give it")
    number = to_si(shown_value(value), "1", table.place(key))
    if not -1.0 <= number <= 1.0:
        raise one.wrong(key, expected, f"write as in {key} = {example}")
    return number
