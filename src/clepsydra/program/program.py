"""The step program: the straight-line list of operations that everything is printed from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain

from clepsydra.base.signal import Signal, identifier
from clepsydra.program.counted_loop import Table
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of, with_signal
from clepsydra.program.operation import Operation
from clepsydra.program.routine import RoutineCall


@dataclass(frozen=True)
class ForLoop:
    """A counted loop: ``for i in 0 … count-1: carried = body(tables[:, i], carried, invariants)``.

    The arguments of `body` are one entry of each table, then the carried values, then the
    oldest value of each ring, then the invariants; its results are the next carried values,
    then the value to write to each ring.

    The rings of a loop advance once a turn: the oldest value of a ring of length n is what was
    written n turns before, in this sample or an earlier one. Such a loop stands in the block
    of a program, not inside another loop or a conditional, so that it runs in every sample.

    An adjustable loop has neither rings nor tables and stands in the block of a program too. A
    kernel may be told another number of turns for a run; everything else takes `count`.

    Parameters
    ----------
    targets : tuple of int
        Values that hold the carried values after the last turn.
    count : int
    body : Block
    tables : tuple of tuple of float
        Shape (tables, count).
    carried, invariants : tuple of int
        Values outside the loop.
    name : str
    rings : tuple of DelayRing
    adjustable : bool

    Raises
    ------
    ValueError
        A loop in the body has rings or is adjustable, or this one is and has rings or tables.

    Examples
    --------
    Three turns that add up a table, from 0:

    >>> body = Block(2, (Operation(2, "add", (1, 0)),), (2,))
    >>> total = ForLoop((1,), 3, body, ((1.0, 2.0, 4.0),), (0,), (), "total")
    >>> read_by(total)
    (0,)
    """

    targets: tuple[int, ...]
    count: int
    body: Block
    tables: tuple[tuple[float, ...], ...]
    carried: tuple[int, ...]
    invariants: tuple[int, ...]
    name: str
    rings: tuple[DelayRing, ...] = ()
    adjustable: bool = False

    def __post_init__(self) -> None:
        if self.adjustable and (self.rings or self.tables):
            raise ValueError(f"{self.name}: the length of rings and tables fixes its turns")
        _refuse_outermost(self.name, self.body)


@dataclass(frozen=True)
class Conditional:
    """A block that counts where a condition is true: ``carried = c ? body(…) : carried``.

    The arguments of `body` are the carried values, then the invariants; its results are the
    next carried values. The meaning is that of computing the body and selecting each result;
    a printer may branch around the body, which then costs nothing where it is not needed.

    Parameters
    ----------
    targets : tuple of int
        Values that hold the carried values afterwards.
    condition : int
        A truth value.
    body : Block
    carried, invariants : tuple of int
        Values outside the body.
    name : str

    Raises
    ------
    ValueError
        A loop in the body has rings or is adjustable.

    Examples
    --------
    >>> body = Block(1, (Operation(1, "constant", (), 0.5), Operation(2, "multiply", (0, 1))), (2,))
    >>> halve = Conditional((3,), 2, body, (0,), (), "halve")
    >>> read_by(halve), written_by(halve)
    ((2, 0), (3,))
    """

    targets: tuple[int, ...]
    condition: int
    body: Block
    carried: tuple[int, ...]
    invariants: tuple[int, ...]
    name: str

    def __post_init__(self) -> None:
        _refuse_outermost(self.name, self.body)


@dataclass(frozen=True)
class Call:
    """A call of a block: ``next state, outputs = program(state, inputs)``.

    The printers call what they print once; the engine computes the called program in place
    (`clepsydra.program.inlined`), with the same bits.

    Parameters
    ----------
    targets : tuple of int
        Values that hold the next state of the block, then its outputs.
    program : Program
        The block, without parameters and without loops that have rings.
    instance : str
        What this one is called: a path, as of a signal.
    arguments : tuple of int
        The state that it goes on from, then its inputs.

    Raises
    ------
    ValueError
        A loop of the block has rings or is adjustable.

    Examples
    --------
    >>> double = Program("double", (), (Signal("a"),), (), (Signal("b"),),
    ...                  Block(1, (Operation(1, "add", (0, 0)),), (1,)))
    >>> read_by(Call((7,), double, "twice", (3,))), written_by(Call((7,), double, "twice", (3,)))
    ((3,), (7,))
    """

    targets: tuple[int, ...]
    program: Program
    instance: str
    arguments: tuple[int, ...]

    def __post_init__(self) -> None:
        _refuse_outermost(self.instance, self.program.block)

    @property
    def identifier(self) -> str:
        """The name of the instance as an identifier of a programming language."""
        return identifier(self.instance)

    def ports(self) -> Iterator[tuple[Signal, int]]:
        """Yield each input of the block with its value."""
        first = len(self.program.state)
        return zip(self.program.inputs, self.arguments[first:], strict=True)


Statement = Operation | ForLoop | Conditional | Call | RoutineCall


@dataclass(frozen=True)
class Block:
    """Statements over numbered values; values 0 … arguments-1 are the block's arguments.

    Every value is assigned once. `truths` are the values that are truth values, all others
    are numbers; arguments and results are always numbers.

    Examples
    --------
    >>> block = Block(2, (Operation(2, "add", (0, 1)), Operation(3, "square_root", (2,))), (3,))
    >>> [operation.code for operation in block.operations()], block.uses()
    (['add', 'square_root'], {3: 1, 0: 1, 1: 1, 2: 1})
    """

    arguments: int
    statements: tuple[Statement, ...]
    results: tuple[int, ...]
    truths: frozenset[int] = field(default=frozenset(), repr=False)

    @cached_property
    def made(self) -> dict[int, Operation]:
        """The operation that makes each value that one makes, apart from those of bodies."""
        return {each.target: each for each in self.statements if isinstance(each, Operation)}

    def uses(self) -> dict[int, int]:
        """Return how often each value is read, results included."""
        return dict(Counter(chain(self.results, *map(read_by, self.statements))))

    def without_unread(self) -> Block:
        """Return the block without the statements whose values nothing reads.

        A loop with rings stays: what it writes is read in later samples.

        >>> unread = Operation(1, "negate", (0,))
        >>> Block(1, (unread, Operation(2, "add", (0, 0))), (2,)).without_unread().statements
        (Operation(target=2, code='add', arguments=(0, 0), constant=0.0, fused=False),)
        """
        needed = set(self.results)
        kept: list[Statement] = []
        for statement in reversed(self.statements):
            lasting = isinstance(statement, ForLoop) and statement.rings
            if lasting or needed.intersection(written_by(statement)):
                needed.update(read_by(statement))
                kept.append(statement)
        kept.reverse()
        return replace(self, statements=tuple(kept), truths=self.truths & needed)

    def with_statements(self, change: Callable[[Statement], Statement]) -> Block:
        """Return the block with its statements changed, behind those of their own bodies."""

        def changed(each: Statement) -> Statement:
            if isinstance(each, (ForLoop, Conditional)):
                each = replace(each, body=each.body.with_statements(change))
            elif isinstance(each, RoutineCall):
                each = each.with_operations(change)
            return change(each)

        return replace(self, statements=tuple(map(changed, self.statements)))

    def operations(self) -> Iterator[Operation]:
        """Yield every operation, those of loops, conditionals and blocks included, once a place."""
        for statement in self.statements:
            if isinstance(statement, Operation):
                yield statement
            elif isinstance(statement, RoutineCall):
                yield from statement.routine.operations()
            elif isinstance(statement, Call):
                yield from statement.program.block.operations()
            else:
                yield from statement.body.operations()


def read_by(statement: Statement) -> tuple[int, ...]:
    """Return the values that a statement reads."""
    if isinstance(statement, Operation):
        return statement.arguments
    if isinstance(statement, ForLoop):
        return statement.carried + statement.invariants
    if isinstance(statement, (Call, RoutineCall)):
        return statement.arguments
    return (statement.condition, *statement.carried, *statement.invariants)


def written_by(statement: Statement) -> tuple[int, ...]:
    """Return the values that a statement assigns."""
    return (statement.target,) if isinstance(statement, Operation) else statement.targets


def _refuse_outermost(name: str, body: Block) -> None:
    for statement in body.statements:
        if isinstance(statement, ForLoop) and (statement.rings or statement.adjustable):
            has = "has rings" if statement.rings else "is adjustable"
            raise ValueError(
                f"{name}: the loop {statement.name} {has}, so it must stand in the block of "
                "a program"
            )


@dataclass(frozen=True)
class Program:
    """One sample of a step law or of a closed loop, ready for any printer.

    The arguments of `block` are the state, then the inputs, then the parameters; its results
    are the next state, then the outputs. The argument of a delay ring is its oldest value and
    its result the value to write. The rings of loops belong to what lives from sample to sample
    too; they have names of their own.

    Parameters
    ----------
    name : str
    state : tuple of Signal or DelayRing
    inputs, parameters, outputs : tuple of Signal
    block : Block
    names : mapping
        Names that the law gave to values on the way.
    description : tuple of str
        What a block does, a line each.
    constants : tuple of Signal
    tables : tuple of Table
        Numbers of the block that are printed by their names.
    words : mapping
        Of names, outputs and states what a reader is told above the step that computes one.

    Raises
    ------
    ValueError
        A ring of a loop has the name of a state or of another such ring.

    Examples
    --------
    An accumulator: its next state and its output are the sum of state and input.

    >>> block = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("sum", (Signal("total"),), (Signal("flow"),), (), (Signal("y"),), block)
    >>> program.state_arguments, program.input_arguments, program.next_state, program.output_values
    (range(0, 1), range(1, 2), (2,), (2,))
    """

    name: str
    state: tuple[Signal | DelayRing, ...]
    inputs: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    block: Block
    names: dict[int, str] = field(default_factory=dict)
    description: tuple[str, ...] = ()
    constants: tuple[Signal, ...] = ()
    words: Mapping[str, str] = field(default_factory=dict)
    tables: tuple[Table, ...] = ()

    def __post_init__(self) -> None:
        taken = [entry.name for entry in (*self.state, *self.rings)]
        clash = sorted({ring.name for ring in self.rings if taken.count(ring.name) > 1})
        if clash:
            raise ValueError(f"program {self.name}: {clash} stand for more than one state or ring")

    def with_signals(self, change: Callable[[Signal], Signal]) -> Program:
        """Return the program with its signals and constants changed.

        >>> law = Program("law", (), (Signal("u"),), (), (), Block(1, (), ()))
        >>> law.with_signals(lambda signal: replace(signal, unit="V")).inputs[0].unit
        'V'
        """

        def in_rings(each: Statement) -> Statement:
            if not isinstance(each, ForLoop) or not each.rings:
                return each
            rings = (replace(ring, signal=change(ring.signal)) for ring in each.rings)
            return replace(each, rings=tuple(rings))

        return replace(
            self,
            state=tuple(with_signal(entry, change) for entry in self.state),
            inputs=tuple(map(change, self.inputs)),
            parameters=tuple(map(change, self.parameters)),
            outputs=tuple(map(change, self.outputs)),
            constants=tuple(map(change, self.constants)),
            block=replace(self.block, statements=tuple(map(in_rings, self.block.statements))),
        )

    def with_calls(self, change: Callable[[Call], Call]) -> Program:
        """Return the program with the calls of its blocks changed."""
        statements = (change(s) if isinstance(s, Call) else s for s in self.block.statements)
        return replace(self, block=replace(self.block, statements=tuple(statements)))

    @cached_property
    def given(self) -> tuple[Signal, ...]:
        """The signals of the arguments of the block, in order."""
        return (*map(signal_of, self.state), *self.inputs, *self.parameters)

    @cached_property
    def rings(self) -> tuple[DelayRing, ...]:
        """The rings of the loops in the block, in order."""
        loops = (loop for loop in self.block.statements if isinstance(loop, ForLoop))
        return tuple(ring for loop in loops for ring in loop.rings)

    @property
    def calls(self) -> tuple[Call, ...]:
        """The calls of blocks, in order."""
        return tuple(each for each in self.block.statements if isinstance(each, Call))

    @property
    def state_arguments(self) -> range:
        """The values that are the state."""
        return range(len(self.state))

    @property
    def input_arguments(self) -> range:
        """The values that are the inputs."""
        return range(len(self.state), len(self.state) + len(self.inputs))

    @property
    def parameter_arguments(self) -> range:
        """The values that are the parameters."""
        first = len(self.state) + len(self.inputs)
        return range(first, first + len(self.parameters))

    @property
    def next_state(self) -> tuple[int, ...]:
        """The values that are the next state."""
        return self.block.results[: len(self.state)]

    @property
    def output_values(self) -> tuple[int, ...]:
        """The values that are the outputs."""
        return self.block.results[len(self.state) :]
