"""An argument of a design: declared once, for study files, calls, editors and the page of docs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.base.key import Key
from clepsydra.base.quantity import Quantity

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

#: A table, a key of it and a process to an argument.
Read = Callable[["TableReader", str, "Process"], Any]
#: What a call may give in its place, see `Argument`.
Given = Literal["", "quantity", "of signals", "table"]


@dataclass(frozen=True, eq=False)
class Argument:
    """An argument of a design.

    Parameters
    ----------
    name : str
        That of the parameter of the design.
    read : callable
        (table, key, process) → what the design takes; it refuses with place and remedy.
    properties : mapping
        The keys of a study file that make it, one by its own name as a rule, and what an editor
        is told of each, in the words of JSON Schema.
    given : {"", "quantity", "of signals", "table"}
        What a call of `cl.design` may give: what the design takes; also text with a unit; text or
        a number in the unit that people see of a signal; or tables as a study file has them.
    check : callable
        Refuses a value that the design cannot take, from wherever it comes.

    Examples
    --------
    >>> flag("as_published", "true keeps the settings").properties["as_published"]["type"]
    'boolean'
    """

    name: str
    read: Read
    properties: Mapping[str, Mapping[str, Any]]
    given: Given = ""
    check: Callable[[Any], None] = lambda value: None

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of a study file that make it."""
        return tuple(self.properties)


def argument(name: str, read: Read, words: str, schema: Mapping[str, Any], *more: Any) -> Argument:
    """Return an argument that one key of its own name makes; more as in `Argument`."""
    return Argument(name, read, {name: {"description": words, **schema}}, *more)


def of_quantity(declared: Quantity, words: str = "") -> Argument:
    """Return an argument that is a quantity, by its declaration.

    Parameters
    ----------
    words : str
        What it is, where that is more than what is expected of it.

    Examples
    --------
    >>> time = Quantity("lag", "s", low=0.0, strict=True, expected="a time", remedy="give one")
    >>> of_quantity(time, "of all loops").properties["lag"]["description"]
    'of all loops [s], above 0'
    """

    def read(table: TableReader, key: str, process: Process) -> float:
        return float(table.declared(declared, {}, MISSING))

    schema = declared.schema(words=words)
    return Argument(declared.name, read, {declared.name: schema}, "quantity", declared.check)


def of_key(key: Key) -> Argument:
    """Return the argument that a design of one's own declares as a key, above its low bound."""
    written = f'"{key.default:g} {key.unit}"' if key.unit != "1" else f"{key.default:g}"
    return of_quantity(
        Quantity(
            key.name,
            key.unit,
            low=key.low,
            high=key.high,
            expected=key.words,
            remedy=f"write as in {written}",
            strict=key.low > -float("inf"),
        )
    )


def number(
    name: str, expected: str, words: str, *, example: str, above: float = 0.0, **more: Any
) -> Argument:
    """Return an argument that is a `Quantity` above a bound, written as in the example."""
    declared = Quantity(
        name, low=above, strict=True, expected=expected, remedy=f"write as in {example}", **more
    )
    return of_quantity(declared, words)


def word(name: str, words: str, choices: Any) -> Argument:
    """Return an argument that is one of a few words, those of a `Literal`.

    Examples
    --------
    >>> word("primary", "what controls", Literal["polynomial", "PI"]).properties["primary"]["enum"]
    ['polynomial', 'PI']
    """
    known = literal_words(choices)
    return argument(
        name, lambda table, key, process: table.choice(key, known, known[0]), words,
        {"enum": list(known)}, "", lambda value: check_choice(name, value, known),
    )  # fmt: skip


def literal_words(choices: Any) -> tuple[str, ...]:
    """Return the words of a `Literal`, or of a union of several.

    Examples
    --------
    >>> literal_words(Literal["a"] | Literal["b", "c"])
    ('a', 'b', 'c')
    """
    found = get_args(choices)
    return tuple(word for each in found for word in (get_args(each) or (each,)))


def flag(name: str, words: str) -> Argument:
    """Return an argument that is true or false."""

    def read(table: TableReader, key: str, process: Process) -> bool:
        return table.flag(key, default=False)

    return argument(name, read, words, {"type": "boolean"})


def whole_number(name: str, words: str, most: int | None = None) -> Argument:
    """Return an argument that is a whole number from 1."""
    bounds = {"minimum": 1} if most is None else {"minimum": 1, "maximum": most}
    expected = f"a whole number from 1{'' if most is None else f' to {most}'}"

    def check(value: Any) -> None:
        whole = isinstance(value, int) and not isinstance(value, bool)
        if not whole or value < 1 or (most is not None and value > most):
            raise InputError(name, value, expected, "write as in 6")

    def read(table: TableReader, key: str, process: Process) -> int:
        written = table.raw(key)
        try:
            check(written)
        except InputError as error:
            raise table.wrong(key, expected, error.remedy) from None
        return cast(int, written)

    return argument(name, read, words, {"type": "integer", **bounds}, "", check)
