"""The draws in JAX: equilibria, the loop from there, and the loop with noise, on two threads."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from benchmarks.case import GRAVITY, NOMINAL, Case, Solution
from benchmarks.with_jax import closed_loop, jax_set_up

#: Newton's steps: from a point 5 % away the fourth is at the last digit.
NEWTON_STEPS = 5
#: Draws in a call: of 512 to half of all, those that take the least of the processors.
PART = 4096
THREADS = 2
SEED = 1


class DrawsInJax:
    """All draws of a case, in parts that two threads share, each from its own equilibrium.

    Parameters
    ----------
    case : Case
        With sensors of each draw's own.
    deviation : float
        Of the noise of both measurements [V].
    """

    def __init__(self, case: Case, deviation: float) -> None:
        jax = jax_set_up()
        assert case.individual is not None
        self._jax, self._deviation = jax, deviation
        setpoints, near = jax.device_put(case.setpoints), case.initial_levels

        def rest(parameters: Any, gains: Any, key: Any) -> list[Any]:
            return _equilibrium(near, parameters, gains, setpoints[0])

        def quiet(parameters: Any, gains: Any, key: Any) -> list[Any]:
            found = rest(parameters, gains, key)
            return closed_loop(parameters, setpoints, gains, found[:4], found[4:])

        def noisy(parameters: Any, gains: Any, key: Any) -> list[Any]:
            found = rest(parameters, gains, key)
            return closed_loop(
                parameters, setpoints, gains, found[:4], found[4:],
                lambda number: self._noise(key, number),
            )  # fmt: skip

        self._rest, self._quiet, self._noisy = (
            jax.jit(jax.vmap(law, in_axes=(1, 1, 0))) for law in (rest, quiet, noisy)
        )
        keys = jax.random.split(jax.random.key(SEED), case.scenarios)
        self._parts = [
            (
                jax.device_put(case.parameters[:, first : first + PART]),
                jax.device_put(case.individual[:2, first : first + PART]),
                keys[first : first + PART],
            )
            for first in range(0, case.scenarios, PART)
        ]

    def rest(self) -> np.ndarray:
        """Return the levels and voltages at rest [6, draws]."""
        return self._all(self._rest)

    def quiet(self) -> Solution:
        """Return what all draws end with."""
        return Solution(self._all(self._quiet))

    def noisy(self) -> Solution:
        """Return what all draws end with, with noise."""
        return Solution(self._all(self._noisy))

    def noise(self, draws: int, samples: int) -> np.ndarray:
        """Return the noise that the first draws have [samples, 2, draws]."""
        jax = self._jax
        of_draw = jax.vmap(self._noise, in_axes=(None, 0))
        of_all = jax.vmap(of_draw, in_axes=(0, None), out_axes=2)
        keys = self._parts[0][2][:draws]
        return np.array(of_all(keys, jax.numpy.arange(samples)))

    def _noise(self, key: Any, number: Any) -> Any:
        """Return the noise of one draw in a sample, by threefry."""
        random = self._jax.random
        return self._deviation * random.normal(random.fold_in(key, number), (2,))

    def _all(self, law: Any) -> np.ndarray:
        def one(part: tuple[Any, ...]) -> np.ndarray:
            return np.array(self._jax.block_until_ready(law(*part)))

        with ThreadPoolExecutor(THREADS) as pool:
            return np.hstack(list(pool.map(one, self._parts)))


def _equilibrium(near: np.ndarray, parameters: Any, gains: Any, targets: Any) -> list[Any]:
    """Return levels and voltages at rest by Newton's method in the roots of the levels.

    All equations but those of the two sensors are linear in the roots and the voltages, so they
    hold after every step: what is left of the step's linear system is solved by hand.
    """
    p = dict(zip(NOMINAL, parameters, strict=True))
    fall = np.sqrt(2 * GRAVITY)
    out = [fall * p[f"outlet_area_{tank}"] for tank in (1, 2, 3, 4)]
    below = [p[f"split_{pump}"] * p[f"pump_gain_{pump}"] for pump in (1, 2)]
    above = [(1 - p[f"split_{pump}"]) * p[f"pump_gain_{pump}"] for pump in (1, 2)]
    size = below[0] * below[1] - above[0] * above[1]
    roots: Sequence[Any] = [np.sqrt(level) for level in near]
    voltages: Sequence[Any] = []
    for _ in range(NEWTON_STEPS):
        lower = [
            root - (gain * root**2 - target) / (2 * gain * root)
            for root, gain, target in zip(roots[:2], gains, targets, strict=True)
        ]
        flows = [out[tank] * lower[tank] for tank in (0, 1)]
        voltages = [
            (below[1] * flows[0] - above[1] * flows[1]) / size,
            (below[0] * flows[1] - above[0] * flows[0]) / size,
        ]
        roots = [*lower, above[1] * voltages[1] / out[2], above[0] * voltages[0] / out[3]]
    return [*(root**2 for root in roots), *voltages]
