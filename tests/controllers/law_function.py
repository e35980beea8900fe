"""The function of a law on plain numbers, some thousand times a test."""

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np

Numbers = Sequence[float]
Called = Callable[[Numbers, Numbers, Numbers], tuple[list[float], ...]]

_known: dict[int, tuple[object, Called]] = {}


def function_of(law) -> Called:
    """Return what computes next state, outputs and intermediates from state, inputs, parameters.

    Through the buffers of CasADi: to and from its matrices takes far longer than a law does.
    """
    if id(law) not in _known:
        of_expressions = isinstance(law.function, ca.Function)
        _known[id(law)] = law, (_buffered if of_expressions else _plain)(law.function)
    return _known[id(law)][1]


def _plain(function) -> Called:
    return lambda *given: tuple(np.array(each).ravel().tolist() for each in function(*given))


def _buffered(function: ca.Function) -> Called:
    buffer, evaluate = function.buffer()  # evaluate has no more than the address of the buffer
    given = [np.zeros(function.numel_in(i)) for i in range(function.n_in())]
    found = [np.zeros(function.numel_out(i)) for i in range(function.n_out())]
    assert [len(a) for a in given] == [function.nnz_in(i) for i in range(len(given))]
    assert [len(r) for r in found] == [function.nnz_out(i) for i in range(len(found))]
    for place, numbers in enumerate(given):
        buffer.set_arg(place, memoryview(numbers))
    for place, numbers in enumerate(found):
        buffer.set_res(place, memoryview(numbers))

    def called(*arguments: Numbers, kept=buffer) -> tuple[list[float], ...]:
        for numbers, values in zip(given, arguments, strict=True):
            numbers[:] = values
        evaluate()
        return tuple(numbers.tolist() for numbers in found)

    return called


def by_path(signals, given):
    """What is given by paths or, as keyword arguments, by identifiers; by paths."""
    paths = {signal.identifier: signal.name for signal in signals}
    return {paths.get(name, name): value for name, value in given.items()}
