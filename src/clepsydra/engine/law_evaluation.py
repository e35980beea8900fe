"""A step law by CasADi's own evaluation, independent of the kernels, slow and sure."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import StepLaw

Array = NDArray[np.float64]


class LawEvaluation:
    """A step law evaluated by CasADi sample by sample, delay rings included.

    Parameters
    ----------
    law : StepLaw
    parameters : ndarray [p]
    state : ndarray [n]
        Initial state; the entry of a delay ring fills the whole ring.
    rings : mapping, optional
        Delay ring to what it holds at first, the oldest first [length].
    """

    def __init__(
        self,
        law: StepLaw,
        parameters: Array,
        state: Array,
        rings: Mapping[str, Array] | None = None,
    ) -> None:
        self._law = law
        self._parameters = parameters
        self._state = np.array(state, dtype=float)
        self._rings = {
            index: deque(map(float, (rings or {}).get(entry.name, [state[index]] * entry.length)))
            for index, entry in enumerate(law.state)
            if isinstance(entry, DelayRing)
        }

    @property
    def state(self) -> Array:
        """State after the last sample [n]; the entry of a delay ring is what was written."""
        return self._state.copy()

    @property
    def rings(self) -> dict[str, Array]:
        """What each delay ring holds after the last sample, the oldest first [length]."""
        return {self._law.state[index].name: np.array(ring) for index, ring in self._rings.items()}

    def step(self, inputs: Array) -> Array:
        """Advance by one sample and return the outputs [q]."""
        for index, ring in self._rings.items():
            self._state[index] = ring.popleft()
        state, outputs, _ = self._law.function(self._state, inputs, self._parameters)
        self._state = np.array(state).ravel()
        for index, ring in self._rings.items():
            ring.append(float(self._state[index]))
        return np.array(outputs).ravel()
