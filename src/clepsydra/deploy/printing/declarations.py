"""The variables that a printed program declares for its signals, in any language."""

from __future__ import annotations

from collections.abc import Container, Iterable
from dataclasses import dataclass

from clepsydra.deploy.printing.heading import comment
from clepsydra.deploy.printing.identifiers import NameRules
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.statements import Language
from clepsydra.program.entries import Entry, is_ring, signal_of
from clepsydra.program.program import Call, Program


@dataclass(frozen=True)
class Variable:
    """A declared variable.

    Parameters
    ----------
    name : str
    type : str
        An elementary type, or the name of a function block whose instance it is.
    initial : tuple of str
        Initial value, one text an entry of an array; empty for the default of the type.
    length : int
        Entries of an array from 0 on; 0 for a variable that is none.
    comment : str
        Unit, range, description and source; on one line.
    is_block : bool
        Whether the type is a function block or a structure.
    """

    name: str
    type: str
    initial: tuple[str, ...] = ()
    length: int = 0
    comment: str = ""
    is_block: bool = False


def declared(
    entries: Iterable[Entry],
    language: Language,
    origin: Origin | None = None,
    turned: Container[Entry] = (),
) -> tuple[Variable, ...]:
    """Declare signals with their initial values; a ring is an array, with its position.

    Parameters
    ----------
    entries : iterable of Signal or DelayRing
    language : Language
    origin : Origin, optional
        Where the numbers come from.
    turned : container of DelayRing
        The rings that advance with the turns of a loop.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.c99.statements import C99
    >>> declared([Signal("tank.level", "m", initial=0.1)], C99("law", "single"))[0].initial
    ('0.1f',)
    """
    found = []
    for entry in entries:
        signal, length = signal_of(entry), entry.length if is_ring(entry) else 0
        if signal.record:
            whole = Variable(signal.variable, language.record(signal.record), is_block=True)
            found += [whole] if whole not in found else []
            continue
        source = origin.source_of(entry) if origin else ""
        about = comment(entry, source=source, counted="turn" if entry in turned else "sample")
        values, types = (language.initial(signal),) * max(length, 1), language.types
        name = signal.identifier
        found.append(Variable(name, types[signal.kind], values, length, about))
        if length:
            about = "[1] place of the oldest value"
            found.append(Variable(f"{name}_position", types["integer"], ("0",), comment=about))
    return tuple(found)


def records_of(programs: Iterable[Program], language: Language) -> dict[str, list[Variable]]:
    """Return the structures that outputs are members of: name of the type to its members.

    Raises
    ------
    ValueError
        Two structures of one type have different members.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.c99.statements import C99
    >>> from clepsydra.program.program import Block
    >>> told = Signal("pump.conditions.automatic", kind="boolean", record="conditions")
    >>> law = Program("law", (), (Signal("u"),), (), (told,), Block(1, (), (0,)))
    >>> {name: [each.name for each in members]
    ...  for name, members in records_of([law], C99("law", "double")).items()}
    {'law_conditions': ['automatic']}
    """
    found: dict[str, list[Variable]] = {}
    for program in programs:
        held: dict[tuple[str, str], list[Variable]] = {}
        for signal in (each for each in program.outputs if each.record):
            key = language.record(signal.record), signal.variable
            kind, about = language.types[signal.kind], signal.description
            held.setdefault(key, []).append(Variable(signal.part, kind, comment=about))
        for (name, where), members in held.items():
            known = found.setdefault(name, members)
            if [(e.name, e.type) for e in known] != [(e.name, e.type) for e in members]:
                raise ValueError(f"{program.name}: {where} has other members than its type {name}")
    return found


def check_scope(
    place: str, entries: Iterable[Entry], calls: Iterable[Call], rules: NameRules
) -> None:
    """Refuse names of one scope that a language does not accept or cannot tell apart.

    Parameters
    ----------
    place : str
        Where the scope is.
    entries, calls : iterable
        The signals and the instances whose names stand there.
    rules : NameRules

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> check_scope("law", [Signal("level"), Signal("level")], (), NameRules("C", frozenset()))
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: law, level: got 'level', expected a name that differs in C \
from law, level; rename one.
    """
    records: dict[tuple[str, str], str] = {}
    scope: list[tuple[str, str]] = []
    for entry in entries:
        signal, where = signal_of(entry), f"{place}, {entry.name}"
        if signal.record:
            rules.check(signal.part, where)
            records[signal.variable, f"{place}, {signal.owner}"] = ""
            continue
        scope.append((signal.identifier, where))
        if is_ring(entry):
            position = f"{place}, position in {entry.name}"
            scope.append((f"{signal.identifier}_position", position))
    scope += ((call.identifier, f"{place}, {call.identifier}") for call in calls)
    scope = [*records, *scope]
    for name, where in scope:
        rules.check(name, where)
    rules.check_distinct(scope)
