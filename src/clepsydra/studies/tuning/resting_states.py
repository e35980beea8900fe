"""Where a step law rests at the operating point, for any values of its parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.controllers.blocks.status import Mode
from clepsydra.loop.law_begin import inputs_in_mode
from clepsydra.loop.loop import Loop
from clepsydra.loop.standing_in_manual import MOST_SAMPLES, ROUNDING, SAMPLES, followed
from clepsydra.program.delay_ring import DelayRing


class RestingStates:
    """The initial states of one law that rests, for any values of its parameters.

    With other gains another integral makes the same output, and a law that changes its gains
    without a bump remembers the last ones. In manual every law follows what stands at its
    output, or takes it up in its first sample in automatic, so that a few samples in manual at
    rest and one in automatic tell where its states belong; the difference that the values make is
    added to the controller's own initial state.

    Parameters
    ----------
    loop : Loop
        Whose controller starts at rest.
    most : int
        Samples in manual, at most: it stays there until nothing moves any more.
    """

    def __init__(self, loop: Loop, most: int = SAMPLES) -> None:
        self._controller, self._most = loop.controller, most
        at_rest = {**loop.at_rest(), **loop.point.as_dict()}
        self._manual = inputs_in_mode(loop, at_rest, Mode.MANUAL)
        self._automatic = inputs_in_mode(loop, at_rest, Mode.AUTOMATIC)
        law, values = loop.controller.law, loop.controller.values
        self._parameters = np.array([values[each.name] for each in law.parameters])
        self._places = {each.name: place for place, each in enumerate(law.parameters)}
        self._own = self._taken_over(self._parameters[None])

    def at(self, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return the states that rest elsewhere than the controller's own, which they replace.

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
        (count,) = np.broadcast_shapes((1,), *map(np.shape, values.values()))
        cases = np.tile(self._parameters, (count, 1))
        for name, column in values.items():
            cases[:, self._places[name]] = column
        return self._moved(self._taken_over(cases))

    def of(self, other: RestingStates) -> dict[str, float]:
        """Return the initial state of another loop's controller, whose law is the same."""
        moved = {name: float(value[0]) for name, value in self._moved(other._own).items()}
        return {**self._controller.initial_state, **moved}

    def _moved(self, states: np.ndarray) -> dict[str, np.ndarray]:
        """Return the states [states, candidates] that are not where the own ones are, by name."""
        by, initial = states - self._own, self._controller.initial_state
        noticed = np.abs(by) > ROUNDING * np.maximum(1.0, np.abs(self._own))
        return {
            entry.name: initial[entry.name] + moved
            for entry, moved, is_moved in zip(
                self._controller.law.state, by, noticed.any(axis=1), strict=True
            )
            if is_moved and not isinstance(entry, DelayRing)
        }

    def _taken_over(self, cases: np.ndarray) -> np.ndarray:
        """Return the state with parameters [candidates, p], after it took over from manual.

        It was at rest there, see above [states, candidates].
        """
        state = followed(self._controller, self._manual, cases.T, self._most)
        automatic = np.tile(self._automatic, (len(cases), 1))
        return self._controller.law.next_states(state.T, automatic, cases).T


def rested_elsewhere(own: Loop, other: Loop) -> dict[str, float]:
    """Return the initial state of the other loop's controller, whose law is the same.

    As in `RestingStates`, with other values or on another process, and with as many samples in
    manual as an observer needs to come to rest as well.

    Parameters
    ----------
    own : Loop
        Whose controller starts at rest.
    other : Loop
        With the same law.
    """
    here, there = (RestingStates(loop, MOST_SAMPLES) for loop in (own, other))
    return here.of(there)
