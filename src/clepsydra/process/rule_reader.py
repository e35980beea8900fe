"""One entry of the table [uncertainty]: how a parameter is distributed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.signal import Signal
from clepsydra.base.units import split_quantity
from clepsydra.process import told
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader
from clepsydra.process.uncertainty import Rule, Shape

_SHAPES: tuple[Shape, ...] = ("uniform", "normal", "log-normal")
_WITH_DEVIATION = _SHAPES[1:]
_TABLE = {
    "distribution": told.choice("uniform if left out", _SHAPES),
    "within": told.quantity("how far a uniform one reaches from the value"),
    "from": told.quantity("the lower end of a uniform one"),
    "to": told.quantity("its upper end"),
    "deviation": told.quantity("standard deviation, of the logarithm if log-normal"),
    "values": told.quantities("measured values"),
    "weights": {
        "description": "of the measured values, alike if left out",
        "type": "array",
        "items": {"type": "number", "minimum": 0},
    },
    "same_as": told.text("the parameter with the same share above or below its own value"),
}
#: What an entry may have where it is a table.
KEYS = tuple(_TABLE)
#: What an editor is told of an entry.
RULE: told.Schema = {"anyOf": [told.QUANTITY, told.table(_TABLE)]}
_REMEDY = 'write as in "5 %", or { distribution = "normal", deviation = "3 %" }'


def read_rule(table: TableReader, key: str, signal: Signal | None) -> Rule:
    """Read the rule at a key.

    Parameters
    ----------
    signal : Signal or None
        What it is about; None for several parameters, which have no unit in common.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> text = b"a = { from = '26 cm^2', to = '30 cm^2' }"
    >>> table = TableReader(parse(text, "plant.toml"), (), None)
    >>> read_rule(table, "a", Signal("tank_1.area", "m^2")).values
    (0.0026, 0.003)
    """
    found = _rule(table, key, signal)
    return replace(found, written=table.written(key), place=table.place(key))


def _rule(table: TableReader, key: str, signal: Signal | None) -> Rule:
    if not isinstance(table.raw(key), Mapping):
        return Rule(share=_share(table, key, at_least=0.0))
    inner = table.table(key, "a distribution", _REMEDY, KEYS)
    if inner.has("same_as"):
        _only(inner, ("same_as",))
        _of_one(inner, "same_as", signal)
        other = inner.text("same_as", "the name of a parameter", 'write as in "pump_1.gain"')
        return Rule("same as", other=other)
    if inner.has("values"):
        _only(inner, ("values", "weights"))
        values = _measured(inner, _of_one(inner, "values", signal))
        return Rule("values", values=values, weights=_weights(inner, len(values)))
    shape = _SHAPES[_SHAPES.index(inner.choice("distribution", _SHAPES, "uniform"))]
    if inner.has("deviation") and shape not in _WITH_DEVIATION:
        expected = f"a deviation of a distribution that is {' or '.join(_WITH_DEVIATION)}"
        remedy = "name one of them in distribution, or write within in its place"
        raise inner.wrong("deviation", expected, remedy)
    if shape in _WITH_DEVIATION:
        _only(inner, ("distribution", "deviation"))
        return _of_size(inner, "deviation", signal, shape)
    if inner.has("from") or inner.has("to"):
        _only(inner, ("distribution", "from", "to"))
        found = _of_one(inner, "from" if inner.has("from") else "to", signal)
        low, high = (
            read_value(inner, end, found, f"the {which} end", "give both ends")
            for end, which in (("from", "lower"), ("to", "upper"))
        )
        if not low < high:
            raise inner.wrong("from", "a lower end below the upper end", "exchange or correct them")
        return Rule(shape, values=(low, high))
    _only(inner, ("distribution", "within"))
    return _of_size(inner, "within", signal, shape)


def _only(table: TableReader, allowed: Iterable[str]) -> None:
    """Refuse what says something else than the rest of an entry."""
    others = [key for key in KEYS if key not in allowed]
    beside = ", ".join(key for key in allowed if table.has(key))
    table.refuse(others, f"no such key beside {beside}", "remove one of the two")


def _of_one(table: TableReader, key: str, signal: Signal | None) -> Signal:
    """Return the parameter that an entry is about, which has to be one."""
    if signal is None:
        expected = 'a share of each value, as in "5 %", since it is said of several parameters'
        raise table.wrong(key, expected, 'name each parameter, as in "tank_1.area"')
    return signal


def _share(table: TableReader, key: str, **bounds: float) -> float:
    """Read a share of a value."""
    parts = split_quantity(table.raw(key))
    expected = 'a share of its value, as in "5 %"'
    if parts is not None and parts[1] not in ("", "%") and key not in KEYS:
        remedy = f'write {{ within = "{table.raw(key)}" }} for so much in its unit'
        raise table.wrong(key, expected, remedy)
    if parts is not None and parts[1] not in ("", "%"):
        raise table.wrong(key, expected, "give it in percent")
    if parts is None and not is_finite_number(table.raw(key)):
        raise table.wrong(key, expected, _REMEDY)
    return table.quantity(key, "1", "a share of its value", "correct it", at_most=1.0, **bounds)


def _of_size(table: TableReader, key: str, signal: Signal | None, shape: Shape) -> Rule:
    """Read a distribution by how wide it is, as a share of the value or in its unit."""
    written = table.raw(key) if table.has(key) else None
    expected = "a deviation" if shape in _WITH_DEVIATION else "a largest change"
    if written is None:
        raise table.wrong(key, expected, f'write as in {key} = "5 %"')
    parts = split_quantity(written)
    if shape == "log-normal" or (parts is not None and parts[1] == "%"):
        return Rule(shape, share=_share(table, key, above=0.0))
    one = _of_one(table, key, signal)
    size = read_value(table, key, one, expected, "give it", change=True)
    if size <= 0.0:
        raise table.wrong(key, f"{expected} above 0", "correct it")
    return Rule(shape, deviation=size)


def _measured(table: TableReader, signal: Signal) -> tuple[float, ...]:
    values = table.raw("values")
    expected = "a list of at least two values"
    if not isinstance(values, (list, tuple)) or len(values) < 2:
        raise table.wrong("values", expected, 'write as in ["1.9 cm", "2.1 cm"]')
    return tuple(
        read_value(table.with_value("values", each), "values", signal, "a value", "give it")
        for each in values
    )


def _weights(table: TableReader, count: int) -> tuple[float, ...]:
    if not table.has("weights"):
        return ()
    weights = table.raw("weights")
    expected = f"a list of {count} numbers of at least 0, one for each value"
    remedy = "give one for each value, not all of them 0"
    if not isinstance(weights, (list, tuple)) or len(weights) != count:
        raise table.wrong("weights", expected, remedy)
    for weight in weights:
        if not is_finite_number(weight) or not 0.0 <= weight <= 1e20:
            raise table.wrong("weights", expected, remedy)
    if not any(weights):
        raise table.wrong("weights", expected, remedy)
    return tuple(map(float, weights))
