"""A table of a file, read key by key with a message for everything that is wrong."""

from __future__ import annotations

import copy
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING
from typing import Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.quantity import Quantity
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import from_si, split_quantity, to_si, with_percent_hint
from clepsydra.process.component import Component
from clepsydra.process.document import Document

#: An identifier in C and in Structured Text.
IDENTIFIER = re.compile(r"[A-Za-z](?:_?[A-Za-z0-9]){0,39}")
#: No quantity of a plant is larger in SI, and none but zero smaller than its reciprocal: squares
#: and products of larger ones leave the range of floating-point numbers.
_LARGEST = 1e20


class TableReader:
    """One table of a document.

    Parameters
    ----------
    path : tuple of str
        The keys that lead to the table; empty for the whole file. In a list of tables they are
        numbered from "1".
    keys : iterable of str or None
        The keys that the table may have; None for any.
    components : tuple of Component
        Of the process.
    made : mapping
        Name to what an earlier table was made into, for elements that are joined to it: a tank's
        shape.
    general : mapping
        Key of the top of the file to its schema, for who writes it into this table.
    others : mapping
        Key that others use for what a key of this table says to what to write in its place.

    Raises
    ------
    InputError
        It is not a table, or it has a key that is unknown.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> document = parse(b"[tanks.tank_1]\\narea = '28 cm^2'\\n", "plant.toml")
    >>> table = TableReader(document, ("tanks", "tank_1"), ("area", "height"))
    >>> table.quantity("area", "m^2", "an area", "give the cross-section of the tank", above=0.0)
    0.0028
    """

    def __init__(
        self,
        document: Document,
        path: tuple[str, ...],
        keys: Iterable[str] | None,
        *,
        components: tuple[Component, ...] = (),
        made: Mapping[str, Any] | None = None,
        general: Mapping[str, Any] | None = None,
        others: Mapping[str, str] | None = None,
    ) -> None:
        self.components = components
        self.made = made or {}
        self._document = document
        self._path = path
        content: Any = document.tables
        for key in path:
            content = content[int(key) - 1] if isinstance(content, list) else content[key]
        if not isinstance(content, dict):
            raise InputError(
                document.place(*path), shown_value(content), "a table", f"write [{'.'.join(path)}]"
            )
        self._content: dict[str, Any] = content
        known = None if keys is None else tuple(keys)
        for key in content:
            if known is not None and key not in known:
                remedy = suggestion(key, known, "remove or rename it")
                remedy = (others or {}).get(key.lower(), remedy)
                if general and key in general:
                    remedy = "write it at the top of the file, before the first table"
                    is_list = general[key].get("type") == "array"
                    remedy += f', as in {key} = ["{path[-1]}"]' if is_list else ""
                expected = f"one of {', '.join(known)}" if known else "no key in this table"
                raise InputError(self.place(key), key, expected, remedy)

    @property
    def present(self) -> tuple[str, ...]:
        """The keys that the table has, in the order of the file."""
        return tuple(self._content)

    def has(self, key: str) -> bool:
        """Return whether the table has a key."""
        return key in self._content

    def place(self, *key: str) -> str:
        """Return where a key, or the table itself, stands."""
        return self._document.place(*self._path, *key)

    def written(self, key: str) -> object:
        """Return the value of a key as it was written, shortened for a message."""
        return shown_value(self._content.get(key))

    def refused(self, key: str, value: object, expected: str, remedy: str) -> InputError:
        """Return the error that says what is wrong with the value of a key."""
        return InputError(self.place(key), value, expected, remedy)

    def wrong(self, key: str, expected: str, remedy: str) -> InputError:
        """Return the error that says what is expected where a key is missing or otherwise."""
        value = self.written(key) if self.has(key) else Finding(f"no {key}")
        return self.refused(key, value, expected, remedy)

    def refuse(self, keys: Iterable[str], expected: str, remedy: str) -> None:
        """Refuse each of some keys that the table should not have."""
        for key in keys:
            if self.has(key):
                raise self.wrong(key, expected, remedy)

    def raw(self, key: str) -> object:
        """Return the value of a key as TOML has it."""
        return self._content[key]

    def table(
        self, key: str, expected: str, remedy: str, keys: Iterable[str] | None = None
    ) -> TableReader:
        """Return the table below a key; any keys where none are given."""
        self._require(key, expected, remedy)
        return TableReader(self._document, (*self._path, key), keys, components=self.components)

    def tables(
        self, key: str, expected: str, remedy: str, keys: Iterable[str] | None = None
    ) -> tuple[TableReader, ...]:
        """Return the tables of a list; none where the key is missing."""
        rows = self._content.get(key, [])
        if not isinstance(rows, list):
            raise self.wrong(key, expected, remedy)
        known = None if keys is None else tuple(keys)
        return tuple(
            TableReader(
                self._document, (*self._path, key, str(number)), known, components=self.components
            )
            for number in range(1, len(rows) + 1)
        )

    def with_value(self, key: str, value: object) -> TableReader:
        """Return this table with another value at a key: one of a list, so that it can be read."""
        other = copy.copy(self)
        other._content = {**self._content, key: value}
        return other

    def of_range(
        self, key: str, unit: str, ends: tuple[float, float], *, change: bool = False
    ) -> TableReader:
        """Return this table with a key in a unit, where it was written in percent of a range.

        Parameters
        ----------
        unit : str
            SI unit; percent are percent of a signal that is itself a number.
        ends : tuple of float
            Of the range [`unit`].
        change : bool
            Whether it is a difference of two values.
        """
        written = self._content.get(key)
        parts = split_quantity(written)
        if unit == "1" or parts is None or parts[1] != "%":
            return self
        low, high = ends
        value = to_si(written, "1", self.place(key)) * (high - low) + (0.0 if change else low)
        shown = self.display_units("range").get("range", unit)
        return self.with_value(key, f"{from_si(value, unit, shown)!r} {shown}")

    def flag(self, key: str, *, default: bool) -> bool:
        """Return true or false."""
        value = self._content.get(key, default)
        if not isinstance(value, bool):
            raise self.wrong(key, "true or false", "write it without quotes")
        return value

    def choice(self, key: str, choices: Sequence[str], default: str) -> str:
        """Return one of a few words."""
        value = self._content.get(key, default)
        if value not in choices:
            raise self.wrong(
                key, f"one of {', '.join(choices)}", suggestion(str(value), choices, "choose one")
            )
        return str(value)

    def quantity(
        self,
        key: str,
        unit: str,
        expected: str,
        remedy: str,
        *,
        above: float | None = None,
        at_least: float | None = None,
        at_most: float | None = None,
        default: float | None = None,
        typical: float | None = None,
    ) -> float:
        """Return the value of a key [`unit`].

        Parameters
        ----------
        unit : str
            SI unit; "1" for a pure number.
        expected, remedy : str
            What it is ("an area") and what to do where it is wrong.
        above, at_least, at_most : float or None
            Bounds [`unit`].
        default : float or None
            Where the key is missing; None if it must not be.
        typical : float or None
            What could be written [`unit`], shown in the unit of the key "range"; one where None.
        """
        if default is not None and key not in self._content:
            return default
        example = self._in_written_unit("range", typical, unit) if typical else _example(unit)
        value = self._require(key, expected, f'{remedy}, as in {key} = "{example}"')
        number = self._to_si(key, value, unit)
        for bound, words, kept in (
            (above, "above", above is None or number > above),
            (at_least, "of at least", at_least is None or number >= at_least),
            (at_most, "of at most", at_most is None or number <= at_most),
        ):
            if bound is not None and not kept:
                shown = self._in_written_unit(key, bound, unit)
                hinted = with_percent_hint(remedy, value, unit) if bound == at_most else remedy
                raise self.refused(key, shown_value(value), f"{expected} {words} {shown}", hinted)
        return number

    def declared(self, key: Quantity, known: Mapping[str, Any], default: Any) -> Any:
        """Return the value of a declared key [its unit]; the default is `MISSING` for none.

        `known` has the fields on which its unit and its upper bound may depend.
        """
        if default is not MISSING and key.name not in self._content:
            return default
        high = known[key.at_most] if key.at_most else key.high
        low = key.lowest(known) if key.lowest else key.low
        return self.quantity(
            key.name,
            key.unit_of(known),
            key.expected,
            key.remedy,
            above=low if key.strict else None,
            at_least=None if key.strict or low == -math.inf else low,
            at_most=None if high == math.inf else high,
        )

    def range(self, key: str, unit: str, *, at_least: float | None = None) -> tuple[float, float]:
        """Return the lower and upper end of a range [`unit`]."""
        expected = "a range of two quantities"
        remedy = f'write as in {key} = ["0 {unit}", "10 {unit}"]'
        value = self._require(key, expected, remedy)
        if not isinstance(value, list) or len(value) != 2:
            raise self.wrong(key, expected, remedy)
        low, high = (self._to_si(key, end, unit) for end in value)
        if not low < high:
            raise self.wrong(key, "a lower end below the upper end", "exchange or correct them")
        if at_least is not None and low < at_least:
            raise self.wrong(
                key, f"a lower end of at least {self._in_written_unit(key, at_least, unit)}", remedy
            )
        return low, high

    def pairs(
        self, key: str, first_unit: str, second_unit: str, expected: str, remedy: str
    ) -> tuple[tuple[float, float], ...]:
        """Return a list of pairs of quantities [`first_unit`, `second_unit`]."""
        value = self._require(key, expected, remedy)
        if not isinstance(value, list) or not value:
            raise self.wrong(key, expected, remedy)
        for pair in value:
            if not isinstance(pair, list) or len(pair) != 2:
                raise self.refused(key, shown_value(pair), expected, remedy)
        return tuple(
            (self._to_si(key, first, first_unit), self._to_si(key, second, second_unit))
            for first, second in value
        )

    def name(self, key: str, expected: str) -> str:
        """Return the name of another element."""
        remedy = f'write as in {key} = "tank_1"'
        value = self._require(key, expected, remedy)
        if not isinstance(value, str):
            raise self.wrong(key, expected, remedy)
        return value

    def text(self, key: str, expected: str, remedy: str, default: str | None = None) -> str:
        """Return one line of text."""
        if default is not None and key not in self._content:
            return default
        value = self._require(key, expected, remedy)
        if not isinstance(value, str) or not value.isprintable() or not value.strip():
            raise self.wrong(key, expected, remedy)
        return value

    def names(self, key: str, expected: str, remedy: str) -> tuple[str, ...]:
        """Return a list of names, each once and at least one."""
        value = self._require(key, expected, remedy)
        if (
            not isinstance(value, list)
            or not value
            or not all(isinstance(name, str) for name in value)
        ):
            raise self.wrong(key, expected, remedy)
        for name in value:
            if value.count(name) > 1:
                raise self.refused(key, name, "every name once", "remove one of the two")
        return tuple(value)

    def display_units(self, *keys: str) -> dict[str, str]:
        """Return the units that the user wrote, for those of the keys that have one."""
        units = {}
        for key in keys:
            value = self._content.get(key)
            last = value[-1] if isinstance(value, list) and value else value
            parts = split_quantity(last)
            if parts is not None and parts[1]:
                units[key] = parts[1]
        return units

    def _in_written_unit(self, key: str, value: float, unit: str) -> str:
        """Return a value [`unit`] as text in the unit that the user wrote at a key."""
        written = self.display_units(key).get(key, unit)
        return f"{from_si(value, unit, written):g}" + ("" if written == "1" else f" {written}")

    def _to_si(self, key: str, value: object, unit: str) -> float:
        shown = value if isinstance(value, str) else shown_value(value)
        number = to_si(shown, unit, self.place(key))
        if number and not 1 / _LARGEST <= abs(number) <= _LARGEST:
            raise self.wrong(
                key,
                f"zero or a size from {1 / _LARGEST:.0e} to {_LARGEST:.0e}"
                + ("" if unit == "1" else f" {unit}"),
                "correct the number or its unit",
            )
        return number

    def _require(self, key: str, expected: str, remedy: str) -> Any:
        if key not in self._content:
            raise self.wrong(key, expected, remedy)
        return self._content[key]


def checked_name(name: str, place: str) -> str:
    """Return a name that can stand in every program that Clepsydra prints.

    Raises
    ------
    InputError
        It is no identifier.

    Examples
    --------
    >>> checked_name("tank_1", "plant.toml, line 3, tanks.tank_1")
    'tank_1'
    """
    if not IDENTIFIER.fullmatch(name):
        raise InputError(
            place,
            shown_value(name),
            "a name of at most 40 letters, digits and single underscores that begins with a letter",
            "rename it, for example to tank_1",
        )
    return name


def shown_value(value: object) -> object:
    """Return a value as a message shows it: short, and as text unless it is a number.

    Examples
    --------
    >>> shown_value(["0 V", "10 V"])
    '["0 V", "10 V"]'
    """
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**18):
        return value
    text = value if isinstance(value, str) else json.dumps(value, default=str)
    return text[:60] + "…" if len(text) > 60 else text


def _example(unit: str) -> str:
    return "1" if unit == "1" else f"1 {unit}"
