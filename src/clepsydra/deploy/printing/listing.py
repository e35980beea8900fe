"""What a printed program consists of: assignments, loops, branches and calls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import Expression, Notation
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.program.counted_loop import Table
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program


@dataclass(frozen=True)
class Assignment:
    """``name := expression``, the only one that this name gets."""

    name: str
    expression: Expression


@dataclass(frozen=True)
class RingTurn:
    """What one turn of a loop does with a ring that advances with the turns.

    First the variable `oldest` gets the ring's oldest value; empty where the body does not read
    it. After the body `written` takes that value's place and the ring advances.
    """

    ring: DelayRing
    oldest: str
    written: Expression


@dataclass(frozen=True)
class Compound:
    """A counted loop, or what counts where a condition is true: carried variables and a body.

    A turn reads the oldest values of the rings, runs the body, writes the rings and advances
    them, and then updates the carried variables, which what is written may read.

    Parameters
    ----------
    label : str
        What a reader is told that it is.
    start, body, update : tuple
        What the carried variables begin with, and what a turn does and gives them.
    condition : Expression or None
        None for a loop.
    index : str
    turns : range
        The index in each turn.
    rings : tuple of RingTurn
    """

    label: str
    start: tuple[Assignment, ...]
    body: tuple[ListingStatement, ...]
    update: tuple[Assignment, ...]
    condition: Expression | None = None
    index: str = ""
    turns: range = range(1)
    rings: tuple[RingTurn, ...] = ()


@dataclass(frozen=True)
class BlockCall:
    """A call of an instance of a block.

    Parameters
    ----------
    instance : str
        What its outputs are read by.
    program : Program
        The block.
    arguments : tuple of Expression
        One for each of its inputs, as a number.
    kept : str
        The name of what it keeps.
    told : tuple of tuple
        Output or structure of outputs, and the variable that takes it at the call.
    """

    instance: str
    program: Program
    arguments: tuple[Expression, ...]
    kept: str
    told: tuple[tuple[str, str], ...] = ()

    def given(self) -> Iterator[tuple[Signal, Expression]]:
        """Yield each input with its value, in its own type."""
        for signal, value in zip(self.program.inputs, self.arguments, strict=True):
            yield signal, value.to(signal.kind)


@dataclass(frozen=True)
class Repeated:
    """A counted loop over arrays: what is done where an index is first, …, last.

    Parameters
    ----------
    index : str
    first, last, behind : str
        The first index, the last one, and the one behind it; none is taken where last < first.
    body : tuple
    once : bool
        Whether it may have a single turn.
    """

    index: str
    first: str
    last: str
    behind: str
    body: tuple[ListingStatement, ...]
    once: bool


@dataclass(frozen=True)
class Remark:
    """What a reader is told before the next statement."""

    text: str


ListingStatement = Assignment | Compound | BlockCall | Repeated | Remark


def touched(statement: ListingStatement) -> set[str]:
    """Return the names of the variables that a statement reads or assigns.

    Examples
    --------
    >>> from clepsydra.deploy.printing.expressions import variable
    >>> sorted(touched(Assignment("u", Expression("add", (variable("a"), variable("b"))))))
    ['a', 'b', 'u']
    """
    found: set[str] = set()
    given: list[Expression] = []
    if isinstance(statement, Assignment):
        found, given = {statement.name}, [statement.expression]
    elif isinstance(statement, BlockCall):
        found, given = {place for _, place in statement.told}, [*statement.arguments]
    elif isinstance(statement, Repeated):
        found = found.union(*map(touched, statement.body))
    elif isinstance(statement, Compound):
        found = found.union(*map(touched, (*statement.start, *statement.body, *statement.update)))
        given = [turn.written for turn in statement.rings]
        given += [statement.condition] if statement.condition else []
    return found | {part.text for each in given for part in each.parts if part.text}


def assigned(statement: ListingStatement) -> list[str]:
    """Return the names of the variables that a statement computes."""
    if isinstance(statement, Compound):
        return [each.name for each in statement.start]
    return [statement.name] if isinstance(statement, Assignment) else []


@dataclass(frozen=True)
class DeclaredArray:
    """An array of a routine: its length, 0 for one number, and its numbers that never change.

    `initial`: a number for each entry; empty where all of them are assigned.
    """

    length: int
    initial: tuple[float, ...] = ()


@dataclass
class Scope:
    """Where the statements of a program stand, those of its loops and branches included.

    Parameters
    ----------
    notation : Notation
    names : Identifiers
        What the variables are named in.
    known : sequence of Table
        Numbers that loops read by a name.
    tables : dict
        The tables that they read, by name.
    arrays : dict
        The arrays that routines keep numbers in, by name: what each is declared with.
    """

    notation: Notation
    names: Identifiers
    known: Sequence[Table] = ()
    tables: dict[str, Table] = field(default_factory=dict)
    arrays: dict[str, DeclaredArray] = field(default_factory=dict)

    def table(self, table: Table) -> str:
        """Return the name of a table, which all share that read the same numbers."""
        known = (name for name, other in self.tables.items() if table.like(other))
        name = next(known, "") or self.names.new(table.name)
        self.tables[name] = table
        return name
