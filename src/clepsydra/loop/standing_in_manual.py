"""A law that stands in manual until nothing in it moves any more, in one case or in many."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.signal import Signal, elements
from clepsydra.controllers.controller import Controller
from clepsydra.engine.kernel import Kernel
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program
from clepsydra.program.reader import inline
from clepsydra.program.step_law import StepLaw

Array = NDArray[np.float64]

#: Samples in manual, after which one law has taken over what another one holds for it.
SAMPLES = 4
#: As many as an observer may take to come to rest.
MOST_SAMPLES = 5000
#: A state moved by less than this share of its size was moved by rounding.
ROUNDING = 1e-12
#: More cases than this are worth a kernel; it takes so many samples before it is looked who moves.
_FEW, _TOGETHER = 32, 32
_RESTS, _SAMPLE = "rests", "sample"


def followed(controller: Controller, inputs: Array, parameters: Array, most: int) -> Array:
    """Return the states of a law after it stood there until nothing moved any more.

    What is found for a case does not depend on the others, nor on how many they are.

    Parameters
    ----------
    inputs : ndarray [m] or [m, cases]
        Of the law, its outputs in manual.
    parameters : ndarray [p] or [p, cases]
    most : int
        Samples, at most.

    Returns
    -------
    ndarray [n] or [n, cases]
    """
    law = controller.law
    start = np.array([controller.initial_state[entry.name] for entry in law.state])
    (cases,) = shape = np.broadcast_shapes(inputs.shape[1:], parameters.shape[1:]) or (1,)
    given = np.broadcast_to(inputs.reshape(len(inputs), -1), (len(inputs), cases))
    values = np.broadcast_to(parameters.reshape(len(parameters), -1), (len(parameters), cases))
    found = (_many if cases > _FEW else _few)(law, start, given, values, most)
    alone = inputs.ndim == parameters.ndim == 1
    return found[:, 0] if alone else found.reshape(len(start), *shape)


def _few(law: StepLaw, start: Array, inputs: Array, parameters: Array, most: int) -> Array:
    state = np.tile(start, (inputs.shape[1], 1))
    moving = np.arange(len(state))
    for sample in range(most):
        before = state[moving]
        after = law.next_states(before, inputs.T[moving], parameters.T[moving])
        state[moving] = after
        if sample >= SAMPLES:
            still = np.abs(after - before) <= ROUNDING * np.maximum(1.0, np.abs(after))
            moving = moving[~np.all(still, axis=1)]
            if not len(moving):
                break
    return state.T


def _many(law: StepLaw, start: Array, inputs: Array, parameters: Array, most: int) -> Array:
    kernel = _kernel(law)
    names = [entry.name for entry in kernel.program.state]
    own = names[: len(start)]
    given = zip((s.name for s in kernel.program.parameters), [*inputs, *parameters], strict=True)
    known = dict(given)
    state = np.tile(start[:, None], (1, inputs.shape[1]))
    moving = np.arange(inputs.shape[1])
    held: Mapping[str, ArrayLike] = dict(zip(own, state, strict=True))
    for done in range(0, most, _TOGETHER):
        count = min(_TOGETHER, most - done)
        chosen = {name: values[moving] for name, values in known.items()}
        result = kernel.run(count, parameters=chosen, state=held)
        state[:, moving] = result.final_state[: len(own)]
        moves = result.state(_RESTS) == 0.0
        moving = moving[moves]
        if not len(moving):
            break
        held = dict(zip(names, result.final_state[:, moves], strict=True))
    return state


@lru_cache(maxsize=32)
def _kernel(law: StepLaw) -> Kernel:
    """Return the law with its inputs as parameters, a case a scenario, which stays once it rests.

    A delay in it is full of what stands there, so that one entry tells all.
    """
    own = [signal_of(entry) for entry in law.state]
    n, m = len(own), len(law.inputs)
    state = [Signal(name) for name in (*elements("state", n), _RESTS, _SAMPLE)]
    given = [Signal(name) for name in elements("given", m + len(law.parameters))]
    builder = BlockBuilder(len(state) + len(given))
    before, (rests, sample) = list(range(n)), (n, n + 1)
    results = inline(builder, law.function, [*before, *range(n + 2, n + 2 + len(given))])
    after = results[:n]
    one, share = builder.constant(1.0), builder.constant(ROUNDING)
    still = builder.operation("less_equal", builder.constant(float(SAMPLES)), sample)
    for value, last in zip(after, before, strict=True):
        moved = builder.operation("absolute", builder.operation("subtract", value, last))
        size = builder.operation("maximum", one, builder.operation("absolute", value))
        near = builder.operation("less_equal", moved, builder.operation("multiply", share, size))
        still = builder.operation("and", still, near)
    stays = builder.operation("truth", rests)
    pairs = zip(before, after, strict=True)
    held = [builder.operation("select", stays, last, value) for last, value in pairs]
    resting = builder.operation("number", builder.operation("or", stays, still))
    counted = builder.operation("add", sample, one)
    block = builder.finish([*held, resting, counted])
    program = Program(f"{law.name} in manual", tuple(state), (), tuple(given), (), block)
    return Kernel(program, record=False, fuse=False)
