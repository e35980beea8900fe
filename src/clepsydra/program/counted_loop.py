"""Counted loops: written as CasADi calls, recovered as loops, printed as FOR."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

_PREFIX = "counted_loop_"


def counted_loop(
    name: str,
    count: int,
    body: ca.Function,
    *,
    carried: ca.SX,
    tables: Sequence[Sequence[float]] = (),
    invariants: ca.SX | None = None,
) -> ca.SX:
    """Return the carried values after `count` turns of a body, as one call that stays a loop.

    Parameters
    ----------
    name : str
        An identifier.
    count : int
        Number of turns, at least one.
    body : casadi.Function
        SX function (row [tables], carried [c], invariants [v]) → next carried [c], where row
        holds entry i of each table in turn i.
    carried : casadi.SX [c]
        Values before the first turn.
    tables : sequence of sequences
        Shape (tables, count).
    invariants : casadi.SX [v], optional
        Values that every turn reads.

    Raises
    ------
    ValueError
        A count below one, or a table of another length.

    Examples
    --------
    The polynomial 1 + 2x + 3x² by Horner's rule, at x = 2:

    >>> row, total, x = ca.SX.sym("row"), ca.SX.sym("total"), ca.SX.sym("x")
    >>> horner = ca.Function("horner", [row, total, x], [total * x + row])
    >>> value = counted_loop("polynomial", 3, horner, carried=ca.SX(0), tables=[[3, 2, 1]],
    ...                      invariants=x)
    >>> float(ca.Function("f", [x], [value])(2.0))
    17.0
    """
    invariants = ca.SX(0, 1) if invariants is None else invariants
    if count < 1:
        raise ValueError(f"loop {name}: {count} turns, expected at least one")
    if any(len(table) != count for table in tables):
        raise ValueError(f"loop {name}: every table needs {count} entries")
    turn = _kept_as_call(body)
    start = ca.SX.sym("carried", carried.numel())
    constant = ca.SX.sym("invariants", invariants.numel())
    value = start
    for i in range(count):
        value = turn(ca.DM([table[i] for table in tables]), value, constant)
    whole = ca.Function(_PREFIX + name, [start, constant], [value], {"never_inline": True})
    return whole(ca.vec(carried), ca.vec(invariants))


def _kept_as_call(body: ca.Function) -> ca.Function:
    arguments = [ca.SX.sym(f"a{i}", body.numel_in(i)) for i in range(body.n_in())]
    return ca.Function(
        body.name(), arguments, [ca.densify(body(*arguments))], {"never_inline": True}
    )


@dataclass(frozen=True)
class Table:
    """Numbers that loops of a block read, printed by their name: each loop reads a stretch of them.

    Parameters
    ----------
    name : str
    values : tuple of float
    first : int
        What the first of them is the entry for.
    description : str
    over : str
        The table of places for which these are the degrees, if they are.
    lines : tuple of (float, float)
        Slope and zero of the lines over the places, of which the smallest, from 0 to 1, is the
        entry.

    Examples
    --------
    Where loops over other numbers begin, if these are a stretch of it:

    >>> table = Table("share", (0.0, 0.5, 1.0, 0.5), 10)
    >>> [*table.stretches((0.5,))], [*table.stretches((1.0, 0.5))]
    ([11, 13], [12])
    """

    name: str
    values: tuple[float, ...]
    first: int = 0
    description: str = ""
    over: str = ""
    lines: tuple[tuple[float, float], ...] = ()

    def like(self, other: Table) -> bool:
        """Whether another table has the same entries; by their texts, since zeros have signs."""
        return (self.first, repr(self.values)) == (other.first, repr(other.values))

    def stretches(self, values: tuple[float, ...]) -> Iterator[int]:
        """Yield what the first of some numbers may be the entry for."""
        for k in range(len(self.values) - len(values) + 1):
            # By their texts: equal numbers may be zeros of different sign.
            if repr(self.values[k : k + len(values)]) == repr(values):
                yield self.first + k


@dataclass(frozen=True)
class RecoveredLoop:
    """A counted loop read back from a CasADi call: its count, body and tables.

    Examples
    --------
    >>> row, total = ca.SX.sym("row"), ca.SX.sym("total")
    >>> body = ca.Function("body", [row, total, ca.SX(0, 1)], [total + row])
    >>> RecoveredLoop("total", 3, body, [[1.0, 2.0, 4.0]]).count
    3
    """

    name: str
    count: int
    body: ca.Function
    tables: list[list[float]]


def recover_loop(function: ca.Function) -> RecoveredLoop | None:
    """Return the counted loop that a called function stands for, or None for any other call.

    The function of a counted loop is a list of calls of one body; the tables are the constants
    that the calls read.

    Examples
    --------
    >>> row, total = ca.SX.sym("row"), ca.SX.sym("total")
    >>> body = ca.Function("body", [row, total, ca.SX(0, 1)], [total + row])
    >>> value = counted_loop("total", 3, body, carried=ca.SX(0), tables=[[1, 2, 4]])
    >>> law = ca.Function("law", [], [value])
    >>> calls = [k for k in range(law.n_instructions()) if law.instruction_id(k) == ca.OP_CALL]
    >>> recover_loop(law.instructions_sx()[calls[0]].which_function()).tables
    [[1.0, 2.0, 4.0]]
    >>> recover_loop(law) is None
    True
    """
    if not function.name().startswith(_PREFIX):
        return None
    nodes = function.instructions_sx()
    constants: dict[int, float] = {}
    rows: list[list[float]] = []
    body = None
    for k in range(function.n_instructions()):
        if function.instruction_id(k) == ca.OP_CONST:
            constants[function.instruction_output(k)[0]] = function.instruction_constant(k)
        elif function.instruction_id(k) == ca.OP_CALL:
            body = nodes[k].which_function()
            entries = function.instruction_input(k)[: body.numel_in(0)]
            rows.append([constants[entry] for entry in entries])
    if body is None:
        return None
    tables = [list(column) for column in zip(*rows, strict=True)]
    return RecoveredLoop(function.name().removeprefix(_PREFIX), len(rows), body, tables)
