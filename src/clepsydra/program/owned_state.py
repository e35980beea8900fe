"""Blocks whose state lives in their instances: the form that printers call."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from clepsydra.base.signal import Signal
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.inlined import append, renamed
from clepsydra.program.program import Call, Program

#: The input at which an instance begins anew.
RESTART = "restart"
RESTARTS = Signal(RESTART, kind="boolean", description="begins with its start values")
#: The values of a restart and of what a state then starts with; None where nothing restarts it.
Start = tuple[int, int] | None


def with_owned_state(program: Program) -> Program:
    """Return a program in which the state of each call belongs to its instance.

    An instance owns a state that nothing else reads or writes; a choice between it and a
    constant, in a cold start, goes with it. Where its input `restart` holds, the state counts as
    its input start_NAME, and a whole number or truth value as its initial value. Where it has such
    an input it has to hold in the first scan too; one without, which nothing restarts, has no such
    input either. Any other state stays with the caller, as an input of the block and an
    output next_NAME, where no output has that value already; instances of a block that own
    different states are told apart by its name, see `told_apart`.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "flow", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> (call,) = (s for s in with_owned_state(law).block.statements if isinstance(s, Call))
    >>> [signal.name for signal in call.program.inputs]
    ['u', 'restart', 'start_sum']
    >>> state_paths(with_owned_state(law))
    (('flow', 'sum'),)
    """
    if not program.calls:
        return program
    builder = BlockBuilder(program.block.arguments)
    values, place = _Writer(program).written(builder, range(program.block.arguments))
    owning = replace(program, block=builder.finish(values), names=renamed(program, place))
    return told_apart(owning, program)


def owned_by_calls(program: Program) -> frozenset[int]:
    """Return the places of those states that live in instances of blocks."""
    return frozenset(
        value for call in program.calls for value in call.arguments[: len(call.program.state)]
    )


def own_state(program: Program) -> tuple[Entry, ...]:
    """Return what a program itself keeps: its states apart from instances, then rings of loops.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> own_state(Program("law", (Signal("x"),), (), (), (), Block(1, (), (0,))))[0].name
    'x'
    """
    owned = owned_by_calls(program)
    own = (entry for place, entry in enumerate(program.state) if place not in owned)
    return (*own, *program.rings)


def state_paths(program: Program) -> tuple[tuple[str, ...], ...]:
    """Return for each state of a program whose calls own theirs the names that lead to it."""
    paths: list[tuple[str, ...]] = [(signal_of(entry).identifier,) for entry in program.state]
    for call in program.calls:
        for place, path in zip(call.arguments, state_paths(call.program), strict=False):
            paths[place] = (call.identifier, *path)
    return tuple(paths)


@dataclass(frozen=True)
class _Kept:
    """A state of a caller that a call goes on from.

    Where the condition holds (or, if it does not restart, where it fails) the state counts as
    its first value.
    """

    state: int
    condition: int | None = None
    restarts: bool = True
    first: float = 0.0

    @property
    def restart(self) -> tuple[int | None, bool]:
        return self.condition, self.restarts


class _Writer:
    """Writes a program whose calls own their state.

    Parameters
    ----------
    program : Program
    starts : mapping
        Place of a state that its own instance holds to the values of its restart and its start;
        None at the top, where a program begins with its initial values.
    """

    def __init__(self, program: Program, starts: Mapping[int, Start] | None = None) -> None:
        self.program, self.starts = program, starts
        self.uses = program.block.uses()
        self.made = program.block.made
        #: First target of a call to the states that its instance owns, by their place there.
        self.owned = {call.targets[0]: self._owned(call) for call in program.calls if call.targets}

    def _owned(self, call: Call) -> dict[int, _Kept]:
        found: dict[int, _Kept] = {}
        for k, (entry, value) in enumerate(zip(call.program.state, call.arguments, strict=False)):
            kept, target = self._kept(value), call.targets[k]
            if (
                kept is not None
                and not isinstance(entry, DelayRing)
                and self.uses.get(target, 0) == 1
                and self.program.block.results[kept.state] == target
                and all(kept.restart == other.restart for other in found.values())
                and self._begins_alike(entry, kept)
            ):
                found[k] = kept
        return found

    def _kept(self, value: int) -> _Kept | None:
        """Return the state that a value is, or begins as, where nothing else reads it."""
        own = range(len(self.program.state)) if self.starts is None else self.starts
        if self.uses[value] != 1:
            return None
        if value in own:
            return _Kept(value)
        made = self.made.get(value)
        if made is None or made.code != "select" or self.starts is not None:
            return None
        condition, *choices = made.arguments
        for restarts, (first, state) in ((True, choices), (False, choices[::-1])):
            constant = self.made.get(first)
            if constant is None or constant.code != "constant" or state not in own:
                continue
            if self.uses[state] == 1:
                return _Kept(state, condition, restarts, constant.constant)
        return None

    def _begins_alike(self, entry: Signal, kept: _Kept) -> bool:
        """Whether a state begins at a start as in the first scan, and as its block says."""
        if self.starts is not None:
            return True
        initial = signal_of(self.program.state[kept.state]).initial
        starts = initial if kept.condition is None else kept.first
        return starts == initial and (_has_start(entry) or starts == entry.initial)

    def written(
        self, builder: BlockBuilder, arguments: Sequence[int]
    ) -> tuple[list[int], dict[int, int]]:
        """Append the program's block."""
        given = list(arguments)
        passed = {kept.state for owned in self.owned.values() for kept in owned.values()}
        for state, begun in (self.starts or {}).items():
            if state not in passed and begun is not None:
                entry = signal_of(self.program.state[state])
                given[state] = _begun(builder, entry, *begun, given[state])
        return append(builder, self.program.block, given, self._called)

    def _called(self, builder: BlockBuilder, call: Call, place: Mapping[int, int]) -> list[int]:
        """Append a call of a block that owns its state; return what the call's targets are."""
        program, count = call.program, len(call.program.state)
        owned = self.owned[call.targets[0]] if call.targets else {}
        others = [k for k in range(count) if k not in owned]
        arguments = [place[kept.state] for kept in owned.values()]
        arguments += [place[value] for value in call.arguments[count:]]
        arguments += [place[call.arguments[k]] for k in others]
        begun: list[Start] = []
        told = any(kept.condition is not None for kept in owned.values())
        if told or self.starts is not None or any(_has_start(program.state[k]) for k in owned):
            begun = [self._start(builder, kept, place) for kept in owned.values()]
        starts = [start for start in begun if start is not None]
        arguments += [restart for restart, _ in starts[:1]]
        for k, (_, start) in zip(owned, starts, strict=False):
            arguments += [start] if _has_start(program.state[k]) else []
        called, places = _owning(program, list(owned), restarts=bool(starts))
        targets = builder.call(called, call.instance, arguments)
        return [targets[place] for place in places]

    def _start(self, builder: BlockBuilder, kept: _Kept, place: Mapping[int, int]) -> Start:
        """Return where a state begins anew, and with which value."""
        if self.starts is not None:
            return self.starts[kept.state]
        start = builder.constant(signal_of(self.program.state[kept.state]).initial)
        if kept.condition is None:
            return builder.constant(0.0), start
        condition = place[kept.condition]
        restart = condition if kept.restarts else builder.operation("not", condition)
        return restart, start


def _begun(builder: BlockBuilder, entry: Signal, restart: int, start: int, kept: int) -> int:
    """Append what a state goes on from: a truth value, whose start is known, without a choice."""
    if entry.kind != "boolean":
        return builder.operation("select", restart, start, kept)
    if entry.initial:
        return builder.operation("number", builder.operation("or", restart, kept))
    runs_on = builder.operation("not", restart)
    return builder.operation("number", builder.operation("and", runs_on, kept))


def has_starts(block: Program) -> bool:
    """Return whether an instance of a block is told what some of its own states begin with.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> has_starts(Program("count", (Signal("n", kind="integer"),), (), (), (), Block(1, (), (0,))))
    False
    """
    return any(map(_has_start, block.state))


def _owning(program: Program, owned: Sequence[int], *, restarts: bool) -> tuple[Program, list[int]]:
    """Return a block whose instances own some of its states; its caller keeps the others.

    Also returned is where the block's results, next state and outputs, stand among its own.
    """
    others = [k for k in range(len(program.state)) if k not in owned]
    state = tuple(program.state[k] for k in owned)
    kept = tuple(map(signal_of, (program.state[k] for k in others)))
    starts = [_start(program.state[k]) for k in owned if _has_start(program.state[k])]
    begins = (RESTARTS, *starts) if restarts else ()
    inputs = (*program.inputs, *kept, *begins)
    builder = BlockBuilder(len(state) + len(inputs))
    first = len(state) + len(program.inputs)
    place = dict(
        zip((*owned, *others), (*range(len(owned)), *range(first, first + len(kept))), strict=True)
    )
    restart = first + len(kept)
    port = restart
    begun: dict[int, Start] = {}
    for k in owned:
        if not restarts:
            begun[k] = None
        elif _has_start(program.state[k]):
            port += 1
            begun[k] = restart, port
        else:
            begun[k] = restart, builder.constant(signal_of(program.state[k]).initial)
    arguments = [*(place[k] for k in range(len(program.state))), *range(len(state), first)]
    values, at = _Writer(program, begun).written(builder, arguments)
    count = len(program.state)
    results = [*(values[k] for k in owned), *values[count:]]
    places = dict(zip((*owned, *range(count, len(values))), range(len(results)), strict=True))
    following = []
    for k, signal in zip(others, kept, strict=True):
        # What the caller keeps may be an output as it is.
        places[k] = next(
            (place for place in range(len(owned), len(results)) if results[place] == values[k]),
            len(results),
        )
        if places[k] == len(results):
            results.append(values[k])
            following.append(replace(signal, name=f"next_{signal.name}"))
    owning = replace(
        program,
        state=state,
        inputs=inputs,
        outputs=(*program.outputs, *following),
        block=builder.finish(results),
        names=renamed(program, at),
    )
    return owning, [places[k] for k in range(len(values))]


def _has_start(entry: Signal | DelayRing) -> bool:
    """Whether an instance is told its first value: whole numbers and truth values have one."""
    return signal_of(entry).kind == "real"


def _start(entry: Signal | DelayRing) -> Signal:
    signal = signal_of(entry)
    return replace(signal, name=f"start_{signal.name}", description="")


def state_names(program: Program) -> dict[str, str]:
    """Return for the name of each state the one with the instances that it lives in.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "flow", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> state_names(law)
    {'x': 'flow.sum'}
    """
    names = [entry.name for entry in program.state]
    paths = state_paths(with_owned_state(program))
    return {
        name: ".".join(path) if len(path) > 1 else name
        for name, path in zip(names, paths, strict=True)
    }


def told_apart(program: Program, original: Program) -> Program:
    """Return a program in which the variants of a block have names of their own.

    Where one instance of a block keeps a state and the caller of another one that state of it,
    the block has two variants: the second in the order of the calls is named "NAME_2".

    Parameters
    ----------
    program : Program
        Whose calls own their state.
    original : Program
        What it was made from. A name that stands for two different blocks already stays, so that
        a printer refuses it.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> one, two = (Program("b", (), (), (), (), Block(0, (), ()), {}, (t,)) for t in ("x", "y"))
    >>> law = Program("law", (), (), (), (), Block(0, (Call((), one, "first", ()),), ()))
    >>> both = Block(0, (*law.block.statements, Call((), two, "second", ())), ())
    >>> [call.program.name for call in told_apart(replace(law, block=both), law).calls]
    ['b', 'b_2']
    """
    blocks: dict[str, list[Program]] = {}
    for block in _called(original):
        if block not in blocks.setdefault(block.name, []):
            blocks[block.name].append(block)
    variants: dict[str, list[Program]] = {n: [] for n, found in blocks.items() if len(found) == 1}

    def renamed_call(call: Call) -> Call:
        block = call.program.with_calls(renamed_call)
        found = variants.get(block.name, [block])
        if block not in found:
            found.append(block)
        number = 1 + found.index(block)
        name = f"{block.name}_{number}" if number > 1 else block.name
        return replace(call, program=replace(block, name=name))

    return program.with_calls(renamed_call)


def _called(program: Program) -> Iterator[Program]:
    for call in program.calls:
        yield from _called(call.program)
        yield call.program
