"""Where a step law rests at the operating point, for any values of its parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.controllers.blocks.mode import Mode
from clepsydra.loop.loop import Loop
from clepsydra.program.delay_ring import DelayRing

#: Samples in manual at rest, after which one law has taken over what another one holds for it.
_SAMPLES = 4
#: As many as an observer may take to come to rest.
_MOST_SAMPLES = 5000
#: A state moved by less than this share of its size was moved by rounding.
_ROUNDING = 1e-12


def resting_states(loop: Loop, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the states that rest elsewhere than the controller's own, which they replace.

    With other gains another integral makes the same output, and a law that changes its gains
    without a bump remembers the last ones. In manual every law follows what stands at its
    output, so that a few samples in manual at rest tell where its states belong; the
    difference that the values make is added to the controller's own initial state.

    Parameters
    ----------
    loop : Loop
    values : mapping
        Parameter of the law to its value for each candidate [candidates]; the others keep the
        controller's.

    Returns
    -------
    dict
        State of the law to its initial value for each candidate [candidates].

    Examples
    --------
    With a setpoint weight of 0.5 the integral must make up for half of K r = 3 × 6.13 V:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> loop = Loop(cl.design.simc(plant), plant.linear)
    >>> states = resting_states(loop, {"setpoint_weight_1": np.array([1.0, 0.5])})
    >>> (states["integral_1"] - 3.0).round(3)
    array([0.   , 9.197])
    """
    controller = loop.controller
    law = controller.law
    own = _in_manual(loop, {name: np.array([value]) for name, value in controller.values.items()})
    other = _in_manual(loop, {**controller.values, **values})
    found = {}
    for place, entry in enumerate(law.state):
        moved = other[place] - own[place]
        if isinstance(entry, DelayRing):
            continue
        if np.any(np.abs(moved) > _ROUNDING * np.maximum(1.0, np.abs(own[place]))):
            found[entry.name] = controller.initial_state[entry.name] + moved
    return found


def rested_elsewhere(own: Loop, other: Loop) -> dict[str, float]:
    """Return the initial state of the other loop's controller, whose law is the same.

    As in `resting_states`, with other values or on another process: samples in manual at rest tell
    where its states belong, as many as an observer needs to come to rest as well.

    Parameters
    ----------
    own : Loop
        Whose controller starts at rest.
    other : Loop
        With the same law.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from dataclasses import replace
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> halved = replace(controller, values={**controller.values, "setpoint_weight_1": 0.5})
    >>> state = rested_elsewhere(Loop(controller, plant.linear), Loop(halved, plant.linear))
    >>> round(state["integral_1"] - 3.0, 3)
    9.197
    """
    before, after = (
        _in_manual(
            loop, {k: np.array([v]) for k, v in loop.controller.values.items()}, _MOST_SAMPLES
        )[:, 0]
        for loop in (own, other)
    )
    state = dict(own.controller.initial_state)
    for place, entry in enumerate(own.controller.law.state):
        moved = float(after[place] - before[place])
        if isinstance(entry, DelayRing) or abs(moved) <= _ROUNDING * max(1.0, abs(before[place])):
            continue
        state[entry.name] += moved
    return state


def _in_manual(
    loop: Loop, values: Mapping[str, np.ndarray | float], most: int = _SAMPLES
) -> np.ndarray:
    """Return the state of a law after some samples in manual at rest [states, candidates].

    After that it goes on until nothing moves any more, up to `most` samples.
    """
    controller, law = loop.controller, loop.controller.law
    now = {**loop.at_rest(), **loop.point.as_dict()}
    now |= {f"{name}.mode": float(Mode.MANUAL) for name in controller.manipulated}
    columns = np.broadcast_arrays(*(values[p.name] for p in law.parameters))
    parameters = np.reshape(columns, (len(law.parameters), -1))
    count = parameters.shape[1]
    inputs = np.repeat(loop.law_inputs(now)[:, None], count, axis=1)
    start = np.array([controller.initial_state[entry.name] for entry in law.state])
    state = np.repeat(start[:, None], count, axis=1)
    for sample in range(most):
        before, state = state, np.array(law.function(state, inputs, parameters)[0])
        still = np.abs(state - before) <= _ROUNDING * np.maximum(1.0, np.abs(state))
        if sample >= _SAMPLES and np.all(still):
            break
    return state
