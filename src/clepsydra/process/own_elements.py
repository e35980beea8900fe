"""A user's own elements: subclasses of `Element` in a Python file beside the process file.

The key ``elements = "my_elements.py"`` of a process file names it. To read such a process file
is to run that Python file with all rights of the user: open only files that you trust.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from clepsydra.base.errors import ClepsydraError, Finding, InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.base.standing import Standing, standing_at
from clepsydra.base.user_code import known_user_code, line_of, shortened, words_of
from clepsydra.base.vanishing import vanishing
from clepsydra.process.declared import undeclared
from clepsydra.process.element import Connection, Element
from clepsydra.process.flow import Flow
from clepsydra.process.hybrid import Delay, Event
from clepsydra.process.kinds import kinds_of
from clepsydra.process.table_reader import TableReader, checked_name

#: Methods of an element, and of what the tuple consists that each returns.
_TUPLES: dict[str, type] = {
    **{"connections": Connection, "brings": str, "flows": Flow, "events": Event, "delays": Delay},
    **dict.fromkeys(("states", "contents", "totals", "memories", "parameters"), Signal),
    **dict.fromkeys(("inputs", "disturbances", "measurements"), Signal),
}
#: Methods of an element that return a value for each of several names.
_MAPPINGS = (
    "to_contents", "to_states", "load_steps", "measured_states", "rates", "stored",
    "concentrations", "sent", "updates", "readings", "noises", "displayed",
)  # fmt: skip


def read_own_kinds(
    general: TableReader, path: Path | None, taken: Iterable[str]
) -> tuple[tuple[type[Element], ...], tuple[Remark, ...]]:
    """Run the Python file that a process file names and return the elements that it defines.

    Parameters
    ----------
    general : TableReader
        The whole process file.
    path : Path or None
        Of the process file; None in the catalogue, which names no Python file.
    taken : iterable of str
        Tables and keys that a process file has already.

    Returns
    -------
    kinds : tuple of type
        Kinds of element. Their methods raise an `InputError` where the user's code fails.
    remarks : tuple of Remark
        The idioms in the file that vanish where its equations are written.
    """
    if not general.has("elements"):
        return (), ()
    expected, remedy = "the name of a Python file", 'write as in elements = "my_elements.py"'
    written = general.text("elements", expected, remedy)
    if path is None:
        raise general.refused(
            "elements", written[:60], "no Python file in the catalogue", "copy the file first"
        )
    if not written.endswith(".py"):
        raise general.refused("elements", written[:60], expected, remedy)
    file = _file(general, path, written)
    try:
        content = read_input(file, "a Python file that can be read")
    except InputError as error:
        raise general.refused(
            "elements", written[:60], error.expected, f"see why not: {error.value}"
        ) from None
    kinds = _kinds(file, content)
    if not kinds:
        expected = "a Python file that defines an element"
        remedy = "add a class MyElement(Element), with Element from clepsydra"
        raise general.refused("elements", written[:60], expected, remedy)
    _check_tables(kinds, set(taken))
    return kinds, tuple(each.told(file.name) for each in vanishing(content))


@contextmanager
def joining_own(kinds: Sequence[type[Element]], general: TableReader) -> Iterator[None]:
    """Say of a failure while elements are joined that own elements do not fit.

    Parameters
    ----------
    kinds : sequence of type
        Own elements; without any, a failure is none of the user's and stays as it is.
    general : TableReader
        The whole process file.
    """
    try:
        yield
    except ClepsydraError:
        raise
    except Exception as error:
        if not kinds:
            raise
        raise general.refused(
            "elements",
            words_of(error),
            "elements that fit together",
            "see that each of your elements names only what is there, and returns a rate for "
            "each of its states and a reading for each of its measurements",
        ) from None


def _file(general: TableReader, path: Path, written: str) -> Path:
    folder = path.parent.resolve()
    try:
        file = (folder / written).resolve()
    except (OSError, RuntimeError):  # a link that leads to itself
        file = folder / written
    if not file.is_relative_to(folder):
        expected = "a Python file in the folder of the process file"
        raise general.refused("elements", written[:60], expected, "move it beside the process file")
    place, value = general.place("elements"), written[:60]
    expected, remedy = "a Python file that exists", "check the name"
    if standing_at(file, place, expected, remedy, value) is not Standing.FILE:
        raise InputError(place, value, expected, remedy)
    return file


@functools.lru_cache(maxsize=64)
def _kinds(file: Path, content: bytes) -> tuple[type[Element], ...]:
    """Return the kinds in a file; the same content gives the same kinds."""
    module = known_user_code(file, content, "own_elements")
    kinds = kinds_of(module)
    for kind in kinds:
        _check_kind(kind, file)
    return tuple(_guarded(kind, file, content) for kind in kinds)


def _unread(kind: type[Element]) -> list[str]:
    """Return the methods that a class lacks, as that which reads what its fields do not declare."""
    missing = sorted(kind.__abstractmethods__)
    own = inspect.getattr_static(kind, "read") is not inspect.getattr_static(Element, "read")
    return missing if own or not undeclared(kind) else [*missing, "read"]


def _check_kind(kind: type[Element], file: Path) -> None:
    place = _class_place(kind, file)
    missing = _unread(kind)
    if missing:
        expected = "a class that says how it is read"
        remedy = "add def read(cls, name, table) as a class method"
        raise InputError(place, Finding(f"no method {', '.join(missing)}"), expected, remedy)
    if not isinstance(inspect.getattr_static(kind, "read"), classmethod):
        expected = "a class that says how it is read"
        remedy = "write @classmethod above def read(cls, name, table)"
        raise InputError(f"{place}.read", Finding("no class method"), expected, remedy)
    for attribute, example in (
        ("kind", '"V-notch weir"'),
        ("table", '"v_notch_weirs"'),
        ("symbol", '"orifice"'),
    ):
        value = getattr(kind, attribute, None)
        if not isinstance(value, str) or not value.isprintable() or not value.strip():
            raise InputError(
                f"{place}.{attribute}",
                Finding(f"no {attribute}") if value is None else shortened(repr(value)),
                "a text",
                f"write as in {attribute} = {example}",
            )
    checked_name(kind.table, f"{place}.table")
    keys = kind.keys or None
    if not isinstance(keys, tuple) or not all(isinstance(key, str) for key in keys):
        raise InputError(
            f"{place}.keys",
            Finding("no keys") if keys is None else shortened(repr(keys)),
            "a tuple of texts",
            'write as in keys = ("source", "destination")',
        )


def _check_tables(kinds: Sequence[type[Element]], taken: set[str]) -> None:
    for kind in kinds:
        if kind.table in taken:
            where = _class_place(kind, Path(inspect.getfile(kind.__mro__[1]))) + ".table"
            expected = "a table that process files do not have yet"
            raise InputError(where, kind.table, expected, "choose another name for the table")
        taken.add(kind.table)


def _pickled(element: Element, file: Path, content: bytes) -> tuple[Any, ...]:
    """Return how an own element is made where it arrives: by running the file of its kind."""
    return _unpickled, (file, content, type(element).table), vars(element)


def _unpickled(file: Path, content: bytes, table: str) -> Element:
    """Return an own element of this kind, without its values."""
    kind = next(kind for kind in _kinds(file, content) if kind.table == table)
    return object.__new__(kind)


def _guarded(kind: type[Element], file: Path, content: bytes) -> type[Element]:
    """Return the kind with methods that say where the user's code fails, and that pickles."""
    methods: dict[str, object] = {"__module__": kind.__module__, "__doc__": kind.__doc__}
    for name in (*_TUPLES, *_MAPPINGS):
        # What is inherited as it is stays as it is: the wiring looks at what is overridden.
        if getattr(kind, name) is not getattr(Element, name):
            methods[name] = _guard(getattr(kind, name), kind, name, file)
    methods["read"] = classmethod(_guard(kind.read.__func__, kind, "read", file))  # type: ignore[attr-defined]
    methods["__reduce__"] = lambda element: _pickled(element, file, content)
    return type(kind.__name__, (kind,), methods)


def _guard(method: Callable[..., Any], kind: type, name: str, file: Path) -> Callable[..., Any]:
    @functools.wraps(method)
    def guarded(*arguments: Any, **named: Any) -> Any:
        where = f"{kind.__name__}.{name}"
        try:
            result = method(*arguments, **named)
            if name in _TUPLES and (inspect.isgenerator(result) or isinstance(result, list)):
                result = tuple(result)  # a generator runs here, where its failure is caught
        except ClepsydraError:
            raise
        except Exception as error:
            remedy = "correct it"
            raise InputError(
                f"{line_of(error, file)}, {where}", words_of(error), "a method that works", remedy
            ) from None
        if name == "read":
            fits = isinstance(result, arguments[0]) and result.name == arguments[1]
            wanted = "cls(name, …)"
        elif name in _MAPPINGS:
            fits = isinstance(result, Mapping) and all(isinstance(key, str) for key in result)
            wanted = "a dictionary with texts as keys"
        else:
            part = _TUPLES[name]
            fits = isinstance(result, tuple) and all(isinstance(value, part) for value in result)
            wanted = f"a tuple of {part.__name__}"
        if not fits:
            raise InputError(
                f"{file.name}, {where}", shortened(repr(result)), wanted, "return that"
            )
        return result

    return guarded


def _class_place(kind: type, file: Path) -> str:
    return f"{file.name}, class {kind.__name__}"
