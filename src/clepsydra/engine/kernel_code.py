"""The code of a kernel, and what it hangs on of a program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.unprinted import Unprinted
from clepsydra.engine.vector_code import vector_code
from clepsydra.program.program import Program


def kernel_code(
    program: Program,
    form: KernelForm,
    printer: Callable[[Program, KernelForm], str] = vector_code,
) -> Unprinted:
    """Return the code of a kernel, for which a program is the same under other names and numbers.

    What is printed is no more than what tells it from others: what a signal is, and its initial
    value, which a kernel is given, are no part of it.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> one, same, other = (
    ...     kernel_code(Program("twice", (), (signal,), (), (Signal("y"),), double), form)
    ...     for signal, form in (
    ...         (Signal("level", "m", initial=1.0), KernelForm(4)), (Signal("flow"), KernelForm(4)),
    ...         (Signal("level", "m", initial=1.0), KernelForm(8)),
    ...     )
    ... )
    >>> one.content == same.content, one.content == other.content
    (True, False)
    """
    numbers: dict[str, str] = {}

    def numbered(name: str) -> str:
        return numbers.setdefault(name, f"{len(numbers)}")

    bare = replace(
        program, name="", names={}, description=(), constants=(), words={}, tables=()
    ).with_signals(lambda signal: Signal(numbered(signal.name)))
    individual, noisy = (
        frozenset(numbers[name] for name in names if name in numbers)
        for names in (form.individual, form.noisy)
    )
    return Unprinted.by(printer, bare, replace(form, individual=individual, noisy=noisy))
