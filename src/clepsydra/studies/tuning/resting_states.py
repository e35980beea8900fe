"""Where a step law rests at the operating point, for any values of its parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.loop.law_begin import (
    MOST_SAMPLES,
    ROUNDING,
    SAMPLES,
    in_manual,
    inputs_in_mode,
)
from clepsydra.loop.loop import Loop
from clepsydra.program.delay_ring import DelayRing


def resting_states(loop: Loop, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the states that rest elsewhere than the controller's own, which they replace.

    With other gains another integral makes the same output, and a law that changes its gains
    without a bump remembers the last ones. In manual every law follows what stands at its
    output, or takes it up in its first sample in automatic, so that a few samples in manual at
    rest and one in automatic tell where its states belong; the difference that the values make is
    added to the controller's own initial state.

    Parameters
    ----------
    values : mapping
        Parameter of the law to its value for each candidate [candidates]; the others keep the
        controller's.

    Returns
    -------
    dict
        State of the law to its initial value for each candidate [candidates].
    """
    controller = loop.controller
    own = controller.values
    # The controller itself goes first, beside the candidates.
    beside = {name: np.append(own[name], value) for name, value in values.items()}
    states = _taken_over(loop, {**own, **beside})
    moved = _moved(controller, states[:, :1], states[:, 1:])
    return {name: controller.initial_state[name] + by for name, by in moved.items()}


def _moved(controller: Controller, before: np.ndarray, after: np.ndarray) -> dict[str, np.ndarray]:
    """Return by how much each state moved [candidates], of those that moved."""
    found = {}
    for entry, one, other in zip(controller.law.state, before, after, strict=True):
        by = other - one
        noticed = np.abs(by) > ROUNDING * np.maximum(1.0, np.abs(one))
        if np.any(noticed) and not isinstance(entry, DelayRing):
            found[entry.name] = by
    return found


def rested_elsewhere(own: Loop, other: Loop) -> dict[str, float]:
    """Return the initial state of the other loop's controller, whose law is the same.

    As in `resting_states`, with other values or on another process, and with as many samples in
    manual as an observer needs to come to rest as well.

    Parameters
    ----------
    own : Loop
        Whose controller starts at rest.
    other : Loop
        With the same law.
    """
    before, after = (
        _taken_over(loop, loop.controller.values, MOST_SAMPLES) for loop in (own, other)
    )
    state = dict(own.controller.initial_state)
    for name, by in _moved(own.controller, before, after).items():
        state[name] += float(by[0])
    return state


def _taken_over(
    loop: Loop, values: Mapping[str, np.ndarray | float], most: int = SAMPLES
) -> np.ndarray:
    """Return the state of a law that took over from manual at rest [states, candidates].

    It stays in manual until nothing moves any more, for at least `SAMPLES` and at most `most`
    samples.
    """
    law, at_rest = loop.controller.law, {**loop.at_rest(), **loop.point.as_dict()}
    columns = np.broadcast_arrays(*(values[p.name] for p in law.parameters))
    parameters = np.reshape(columns, (len(law.parameters), -1))
    state = in_manual(loop, at_rest, parameters, most)
    automatic = inputs_in_mode(loop, at_rest, Mode.AUTOMATIC)
    inputs = np.repeat(automatic[:, None], parameters.shape[1], axis=1)
    return np.array(law.function(state, inputs, parameters)[0])
