"""Arguments by name to the memory that a kernel reads."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError
from clepsydra.engine.batch_noise import BatchNoise
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program

Array = NDArray[np.float64]
Given = Mapping[str, ArrayLike]


class Layout:
    """Where a program's state, parameters and inputs stand in memory.

    Parameters
    ----------
    program : Program
    individual : collection of str
        Inputs that differ from scenario to scenario.
    """

    def __init__(self, program: Program, individual: Collection[str]) -> None:
        self._name = program.name
        self._inputs = {s.name: s.initial for s in program.inputs}
        self._parameters = {s.name: s.initial for s in program.parameters}
        self._state = {
            x.name: (x.signal if isinstance(x, DelayRing) else x).initial
            for x in (*program.state, *program.rings)
        }
        self._lengths = {
            x.name: x.length for x in (*program.state, *program.rings) if isinstance(x, DelayRing)
        }
        self._refuse_unknown("input", dict.fromkeys(individual, 0.0), self._inputs)
        self._shared = [name for name in self._inputs if name not in individual]
        self._individual = [name for name in self._inputs if name in individual]

    def scenarios(
        self, inputs: Given, rings: Given, noise: BatchNoise | None, *columns: Given
    ) -> int:
        """Return the number of scenarios that the arguments speak of.

        Raises
        ------
        InputError
            They speak of different numbers, or of none.
        """
        sizes: dict[int, str] = {}
        for name, value in ((n, v) for group in columns for n, v in group.items()):
            if not _is_number(value) and np.ndim(value) == 1:
                sizes[len(np.asarray(value))] = name
        own = {name: inputs[name] for name in self._individual if name in inputs} | {**rings}
        for name, value in own.items():
            if np.ndim(value) == 2:
                sizes[len(np.asarray(value))] = name
        if noise and noise.scenarios is not None:
            sizes[noise.scenarios] = "numbers of the noise"
        if len(sizes) > 1 or 0 in sizes:
            raise InputError(
                f"run of {self._name}",
                sorted(sizes),
                "one number of scenarios, at least 1",
                f"give {' and '.join(sizes.values())} the same number of entries",
            )
        return next(iter(sizes), 1)

    def state(self, given: Given, scenarios: int, lanes: int) -> Array:
        """Return the initial state, then that of the rings of loops [groups, n + r, lanes]."""
        return self._columns("state", self._state, given, scenarios, lanes)

    def rings(self, given: Given, scenarios: int, lanes: int) -> dict[str, Array]:
        """Return what delay rings hold at first, of those of which it is said.

        Either [1, length, 1] in every scenario, or [groups, length, lanes].
        """
        self._refuse_unknown("delay ring", given, self._lengths)
        found = {name: self._numbers(name, content) for name, content in given.items()}
        for name, content in found.items():
            length = self._lengths[name]
            if content.shape == (length,):
                found[name] = content[None, :, None]
            elif content.shape == (scenarios, length):
                found[name] = _in_lanes(content, lanes)
            else:
                raise self._shape_error(name, content, f"[{length}] or [{scenarios}, {length}]")
        return found

    def noisy(self, noise: BatchNoise) -> list[str]:
        """Return the inputs to which noise is added."""
        self._refuse_unknown("input", dict.fromkeys(noise.inputs, 0.0), self._inputs)
        return [name for name in self._inputs if name in noise.inputs]

    def parameters(self, given: Given, scenarios: int, lanes: int) -> Array:
        """Return the parameters [groups, p, lanes]."""
        return self._columns("parameter", self._parameters, given, scenarios, lanes)

    def shared(self, given: Given, samples: int) -> Array:
        """Return the shared inputs [samples, s]."""
        self._refuse_unknown("input", given, self._inputs)
        table = np.empty((samples, len(self._shared)))
        for index, name in enumerate(self._shared):
            value = self._numbers(name, given.get(name, self._inputs[name]))
            if value.shape not in ((), (samples,)):
                raise self._shape_error(name, value, f"a number or [{samples}]")
            table[:, index] = value
        return table

    def individual(self, given: Given, samples: int, scenarios: int, lanes: int) -> Array:
        """Return the individual inputs [groups, samples, i, lanes]."""
        groups = -(-scenarios // lanes)
        table = np.empty((groups, samples, len(self._individual), lanes))
        for index, name in enumerate(self._individual):
            initial = np.full((scenarios, samples), self._inputs[name])
            value = self._numbers(name, given.get(name, initial))
            if value.shape != (scenarios, samples):
                raise self._shape_error(name, value, f"[{scenarios}, {samples}]")
            table[:, :, index, :] = _in_lanes(value, lanes)
        return table

    def _columns(
        self, kind: str, initial: Mapping[str, float], given: Given, scenarios: int, lanes: int
    ) -> Array:
        """Lanes beyond the last scenario repeat it, so that they compute nothing unusual."""
        self._refuse_unknown(kind, given, initial)
        numbers = {**initial, **given}
        if scenarios == 1 and lanes == 1 and _all_numbers(numbers):
            return np.array([list(numbers.values())], dtype=float).reshape(1, -1, 1)
        groups = -(-scenarios // lanes)
        table = np.empty((groups, len(numbers), lanes))
        padded = np.empty(groups * lanes)
        for place, (name, number) in enumerate(numbers.items()):
            if _is_number(number):
                table[:, place] = number
                continue
            value = self._numbers(name, number)
            if value.ndim > 1:
                raise self._shape_error(name, value, "a number or [scenarios]")
            padded[:scenarios] = value
            padded[scenarios:] = padded[scenarios - 1]
            table[:, place] = padded.reshape(groups, lanes)
        return table

    def _numbers(self, name: str, given: ArrayLike) -> Array:
        try:
            return np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise InputError(
                f"run of {self._name}, {name}", given, "a number or numbers", "give it in SI units"
            ) from None

    def _refuse_unknown(self, kind: str, given: Given, known: Mapping[str, float]) -> None:
        for name in given:
            if name not in known:
                raise InputError(
                    f"run of {self._name}",
                    name,
                    f"one of its {kind}s",
                    f"the {kind}s are {', '.join(known) or 'none'}",
                )

    def _shape_error(self, name: str, value: Array, expected: str) -> InputError:
        return InputError(
            f"run of {self._name}, {name}",
            list(value.shape),
            f"the shape of {expected}",
            "give one value, or one value for each",
        )


def _in_lanes(rows: Array, lanes: int) -> Array:
    """Return rows of scenarios [groups, n, lanes]; lanes beyond the last one repeat it."""
    scenarios, length = rows.shape
    groups = -(-scenarios // lanes)
    padded = np.empty((groups * lanes, length))
    padded[:scenarios] = rows
    padded[scenarios:] = rows[-1]
    return padded.reshape(groups, lanes, length).transpose(0, 2, 1)


def _all_numbers(values: Given) -> bool:
    return all(map(_is_number, values.values()))


def _is_number(value: ArrayLike) -> bool:
    return isinstance(value, (int, float))
