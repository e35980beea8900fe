"""Equations as data: what a law or a block was written as, to be kept and sent elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any, cast

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.equations import Equations, Symbols, function_of

#: The block, and the instance of it, that a function stands for which took the place of a call.
Calls = dict[str, tuple[Any, str]]

_calls: ContextVar[Calls | None] = ContextVar("calls", default=None)


@contextmanager
def keeping_calls() -> Iterator[Calls]:
    """Let every call of a block stay a call in the expressions that are made inside.

    Examples
    --------
    >>> from clepsydra.program.block import Block
    >>> double = Block("double", (Signal("a"),), (), (Signal("b"),),
    ...                lambda s: Equations({}, {"b": 2 * s["a"]}))
    >>> a = ca.SX.sym("a")
    >>> double("twice", {"a": a}, {}).outputs["b"]
    SX((2.*a))
    >>> with keeping_calls():
    ...     found = ca.Function("law", [a], [double("twice", {"a": a}, {}).outputs["b"]])
    >>> [found.instruction_id(k) for k in range(found.n_instructions())].count(ca.OP_CALL)
    1
    """
    calls: Calls = {}
    token = _calls.set(calls)
    try:
        yield calls
    finally:
        _calls.reset(token)


def kept_calls() -> Calls | None:
    """Return the calls that were kept so far; None while they are not.

    Examples
    --------
    >>> kept_calls() is None
    True
    """
    return _calls.get()


@dataclass(frozen=True, eq=False)
class KeptEquations:
    """What equations compute, as a function whose calls of blocks are known.

    Called with expressions as the equations themselves, it writes the same steps again; pickled,
    it needs nothing of the Python that the equations were written in.

    Parameters
    ----------
    function : casadi.Function
        SX function (state, inputs, parameters) → (next state, outputs, intermediates).
    arguments, results : tuple of tuples of str
        The names of its arguments and of its results.
    words : mapping
        As in `Equations`.
    calls : mapping
        Of the functions that it calls those that stand for a block, with block and instance.

    Examples
    --------
    See `kept_equations`.
    """

    function: ca.Function
    arguments: tuple[tuple[str, ...], ...]
    results: tuple[tuple[str, ...], ...]
    words: Mapping[str, str]
    calls: Mapping[str, tuple[Any, str]]

    def __call__(self, symbols: Symbols) -> Equations:
        """Return the results for expressions by name."""
        given = [[ca.SX(symbols[name]) for name in names] for names in self.arguments]
        found = _Rewriting(self.calls).results(self.function, given)
        following, outputs, between = (
            dict(zip(names, ca.vertsplit(ca.densify(values)) if names else (), strict=True))
            for names, values in zip(self.results, found, strict=True)
        )
        return Equations(following, outputs, between, self.words)


#: Returns what a called function gives for its arguments, or None where the call stays.
WrittenOut = Callable[[ca.Function, list[ca.SX]], list[ca.SX] | None]


class _Rewriting:
    """The steps of a function written once more, with the calls of its blocks as they are now."""

    def __init__(
        self, calls: Mapping[str, tuple[Any, str]], written_out: WrittenOut = lambda *_: None
    ) -> None:
        self.calls, self.written_out = calls, written_out
        self._functions: dict[int, ca.Function] = {}

    def results(self, function: ca.Function, given: Sequence[Sequence[ca.SX]]) -> list[ca.SX]:
        """Return the results for the entries of each argument."""
        nodes, work = function.instructions_sx(), dict[int, ca.SX]()
        found = [[ca.SX(0)] * function.nnz_out(i) for i in range(function.n_out())]
        for k in range(function.n_instructions()):
            code = function.instruction_id(k)
            target, source = function.instruction_output(k), function.instruction_input(k)
            if code == ca.OP_INPUT:
                work[target[0]] = given[source[0]][source[1]]
            elif code == ca.OP_OUTPUT:
                found[target[0]][target[1]] = work[source[0]]
            elif code == ca.OP_CONST:
                work[target[0]] = ca.SX(function.instruction_constant(k))
            elif code == ca.OP_CALL:
                values = [work[entry] for entry in source]
                results = self._called(nodes[k].which_function(), values)
                work.update(zip(target, results, strict=True))
            elif len(source) == 1:
                work[target[0]] = ca.SX.unary(code, work[source[0]])
            else:
                work[target[0]] = ca.SX.binary(code, work[source[0]], work[source[1]])
        return [
            ca.SX(function.sparsity_out(i), ca.vertcat(ca.SX(0, 1), *values))
            for i, values in enumerate(found)
        ]

    def _called(self, function: ca.Function, given: list[ca.SX]) -> list[ca.SX]:
        """Return what a call gives: that of a block as the block writes it."""
        if function.name() in self.calls:
            return self._block(*self.calls[function.name()], given)
        sizes = accumulate((function.numel_in(i) for i in range(function.n_in())), initial=0)
        groups = [ca.vertcat(ca.SX(0, 1), *given[a:b]) for a, b in pairwise(sizes)]
        if (found := self.written_out(function, groups)) is not None:
            return found
        return [entry for each in self._anew(function).call(groups) for entry in entries_of(each)]

    def _block(self, block: Any, instance: str, given: list[ca.SX]) -> list[ca.SX]:
        following = [entry.name for entry in block.state]
        state = dict(zip(following, given, strict=False))
        inputs = dict(zip((s.name for s in block.inputs), given[len(state) :], strict=True))
        told = block(instance, inputs, state)
        every = [told.next_state[name] for name in following]
        return [*every, *(told.outputs[signal.name] for signal in block.outputs)]

    def _anew(self, function: ca.Function) -> ca.Function:
        """Return a function that is called, such as a loop, with the calls of blocks inside it."""
        key = function.__hash__()
        if key not in self._functions:
            symbols = [ca.SX.sym(f"a{i}", function.numel_in(i)) for i in range(function.n_in())]
            results = self.results(function, [*map(entries_of, symbols)])
            kept = {"never_inline": True}
            self._functions[key] = ca.Function(function.name(), symbols, results, kept)
        return self._functions[key]


def has_calls(function: ca.Function) -> bool:
    """Return whether a function calls another one.

    >>> x = ca.SX.sym("x")
    >>> has_calls(ca.Function("square", [x], [x * x]))
    False
    """
    return ca.OP_CALL in map(function.instruction_id, range(function.n_instructions()))


def with_calls_written_out(function: ca.Function, written_out: WrittenOut) -> ca.Function:
    """Return a function in which some of its calls are expressions.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> square = ca.Function("square", [x], [x * x], {"never_inline": True})
    >>> plain = with_calls_written_out(
    ...     ca.Function("f", [x], [square(x) + 1]), lambda _, given: [given[0] * given[0]]
    ... )
    >>> [plain.instruction_id(k) for k in range(plain.n_instructions())].count(ca.OP_CALL)
    0
    """
    symbols = [ca.SX.sym(f"a{i}", *function.size_in(i)) for i in range(function.n_in())]
    results = _Rewriting({}, written_out).results(function, [*map(entries_of, symbols)])
    return ca.Function(function.name(), symbols, results, function.name_in(), function.name_out())


def entries_of(values: ca.SX) -> list[ca.SX]:
    """Return the entries that are not zero by the structure of what they stand in.

    >>> entries_of(ca.diag(ca.SX([3, 4])))
    [SX(3), SX(4)]
    """
    return cast("list[ca.SX]", values.nonzeros())


def kept_equations(
    name: str,
    arguments: Sequence[Sequence[Signal | DelayRing]],
    outputs: Sequence[Signal],
    equations: Callable[[dict[str, ca.SX]], Equations],
) -> KeptEquations:
    """Return equations as data; the calls of blocks stay calls, and each block keeps its own.

    Parameters
    ----------
    name, arguments, outputs, equations
        As of `function_of`.

    Examples
    --------
    >>> kept = kept_equations("halve", ([], [Signal("level")], []), [Signal("half")],
    ...                       lambda s: Equations({}, {"half": s["level"] / 2}))
    >>> kept({"level": ca.SX.sym("level")}).outputs["half"]
    SX((level/2))
    """
    if isinstance(equations, KeptEquations):
        return equations
    with keeping_calls() as calls:
        function, written = function_of(name, arguments, outputs, equations)
    groups = tuple(tuple(entry.name for entry in group) for group in arguments)
    results = (groups[0], tuple(s.name for s in outputs), tuple(written.intermediates))
    return KeptEquations(function, groups, results, dict(written.words), dict(calls))
