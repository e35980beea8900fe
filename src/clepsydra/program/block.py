"""Blocks: the parts of a law, each written once and kept whole in what is printed from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.program.counted_loop import Table
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, Symbols, is_scalar


@dataclass(frozen=True, eq=False)
class Block:
    """A part of a law: typed ports, a state, and one pure function over expressions.

    Called, it returns the expressions of its results. While a law is read to be printed
    (`keeping_calls`), the call stays one: the printers write the block once and call it.

    Parameters
    ----------
    name : str
        An identifier; blocks of one name compute the same.
    inputs, outputs : tuple of Signal
    state : tuple of Signal or DelayRing
    equations : callable
        Takes a mapping from the names of state and inputs to expressions and returns the
        `Equations`.
    description : tuple of str
        What it does, a line each, for its reader.
    constants : tuple of Signal
        Numbers of its equations that are printed by their names: value (`initial`), unit, and
        what they are and where they come from. Each stands for every such number in the block.
    tables : tuple of Table
        Numbers that its loops read, printed by their names.

    Examples
    --------
    >>> total = Block(
    ...     "total", (Signal("flow"),), (Signal("volume"),), (Signal("reading"),),
    ...     lambda s: Equations({"sum": s["sum"] + s["flow"]}, {"reading": s["sum"]}),
    ... )
    """

    name: str
    inputs: tuple[Signal, ...]
    state: tuple[Signal | DelayRing, ...]
    outputs: tuple[Signal, ...]
    equations: Callable[[Symbols], Equations]
    description: tuple[str, ...] = ()
    constants: tuple[Signal, ...] = ()
    tables: tuple[Table, ...] = ()

    def __call__(self, instance: str, inputs: Symbols, state: Symbols) -> Equations:
        """Return the results of one instance.

        Parameters
        ----------
        instance : str
            What it is called where it stands.
        inputs, state : mapping
            Name of the block's input or state to an expression.

        Raises
        ------
        InputError
            A port is open, or its value is no scalar.
        """
        self._check(instance, self.inputs, inputs)
        self._check(instance, self.state, state)
        calls = _calls.get()
        if calls is None:
            return self.equations({**inputs, **state})
        given = [state[entry.name] for entry in self.state]
        given += [inputs[signal.name] for signal in self.inputs]
        following = [entry.name for entry in self.state]
        results = [signal.name for signal in self.outputs]
        name = f"kept_call_{len(calls)}"
        calls[name] = self, instance
        # Only its shape is read: what it computes stands in the block.
        arguments = ca.SX.sym("given", len(given))
        shape = ca.SX.zeros(len(following) + len(results)) + ca.sum1(arguments)
        function = ca.Function(name, [arguments], [shape], {"never_inline": True})
        values = ca.vertsplit(function(ca.vertcat(*given)))
        return Equations(
            dict(zip(following, values, strict=False)),
            dict(zip(results, values[len(following) :], strict=True)),
        )

    def _check(self, instance: str, ports: tuple[Signal | DelayRing, ...], given: Symbols) -> None:
        """Refuse values that are not one scalar for each port."""
        place = f"block {self.name}, instance {instance}"
        for port in ports:
            if port.name not in given:
                names = ", ".join(each.name for each in ports)
                raise InputError(
                    place, Finding(f"no value for {port.name}"), f"one scalar for each of {names}",
                    "wire the port",
                )  # fmt: skip
            if not is_scalar(value := given[port.name]):
                shown = f"{' by '.join(map(str, ca.SX(value).shape))} values"
                raise InputError(f"{place}, {port.name}", shown, "a scalar", "wire one of them")


#: Which block, and which instance of it, the functions stand for that took the place of calls.
_calls: ContextVar[dict[str, tuple[Block, str]] | None] = ContextVar("calls", default=None)


@contextmanager
def keeping_calls() -> Iterator[None]:
    """Let every call of a block stay a call in the expressions that are made inside.

    Examples
    --------
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
    token = _calls.set({})
    try:
        yield
    finally:
        _calls.reset(token)


def kept_call(function: ca.Function) -> tuple[Block, str] | None:
    """Return the block and the instance that a function stands for, or None for any other.

    Examples
    --------
    >>> kept_call(ca.Function("law", [], [])) is None
    True
    """
    return (_calls.get() or {}).get(function.name())
