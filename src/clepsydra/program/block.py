"""Blocks: the parts of a law, each written once and kept whole in what is printed from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.program.counted_loop import Table
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.equations import Equations, Symbols, is_scalar
from clepsydra.program.kept_equations import kept_calls, kept_equations


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
        calls = kept_calls()
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

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled: the equations as data."""
        groups = self.state, self.inputs, ()
        kept = kept_equations(self.name, groups, self.outputs, self.equations)
        return vars(replace(self, equations=kept))

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
