"""Noise that a kernel makes while it runs, for each of many scenarios its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError
from clepsydra.engine.compiler import CompiledFunction, signature_of
from clepsydra.engine.host import host
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.noise_code import CHUNK, NOISE, noise_code
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.unprinted import Unprinted
from clepsydra.engine.white_noise import check_below, seed_of

Array = NDArray[np.float64]

#: Group and sample with which a call begins, to its further arguments: pointers, whole numbers.
Further = Callable[[int, int], tuple[Sequence[int], Sequence[int]]]
#: Bytes of a vector, at whose multiples memory is read at once.
_ALIGNMENT = 64
#: Pointers and whole numbers that the function takes.
_SIGNATURE = 3, 3
#: No sample has a number beyond this power of 2, so that sums of them are whole numbers.
_FARTHEST = 61


@dataclass(frozen=True)
class InputNoise:
    """White, normal noise that is added to an input in a stretch of samples.

    Parameters
    ----------
    stream : int
        See `clepsydra.engine.white_noise.stream_of`.
    deviation : float
        Its standard deviation, in the unit of the input.
    first, count : int
        The first sample that has it, and how many.
    """

    stream: int
    deviation: float
    first: int
    count: int


@dataclass(frozen=True, eq=False)
class BatchNoise:
    """The noise of all scenarios of a run.

    Scenario k has the noise of the seed `seed_of(seed, numbers[k])`: deviation times
    `white_noise` of that seed and the input's stream, in every bit. It takes no memory, however
    many samples and scenarios there are.

    Parameters
    ----------
    inputs : mapping
        Input to its noise.
    seed : int
        Below 2³².
    numbers : int or array_like of int [scenarios]
        Below 2³²; one for all scenarios if they have the same noise.
    sample : int
        The sample, of a whole, with which the run begins.

    Examples
    --------
    >>> from clepsydra.engine.white_noise import white_noise
    >>> noise = BatchNoise({"u": InputNoise(stream=5, deviation=0.5, first=0, count=3)}, seed=1)
    >>> from clepsydra import Kernel, Signal, program_of
    >>> from clepsydra.program.step_law import Equations, step_law
    >>> law = step_law("seen", inputs=[Signal("u")], parameters=[], state=[],
    ...                outputs=[Signal("y")], equations=lambda s: Equations({}, {"y": s["u"]}))
    >>> seen = Kernel(program_of(law)).run(3, inputs={"u": 2.0}, noise=noise).output("y")[0]
    >>> bool(np.all(seen == 2.0 + 0.5 * white_noise(1, 5, 0, 3)))
    True
    """

    inputs: Mapping[str, InputNoise]
    seed: int
    numbers: ArrayLike = 0
    sample: int = 0

    @property
    def scenarios(self) -> int | None:
        """How many scenarios the numbers speak of; None if they are one for all."""
        return None if np.ndim(self.numbers) == 0 else len(np.asarray(self.numbers))


class LaidNoise:
    """Noise as a kernel takes it.

    Parameters
    ----------
    noise : BatchNoise
    names : sequence of str
        The noisy inputs in the order of the kernel's.
    scenarios, lanes : int
    cache : ObjectCache or None
        Of compiled functions.

    Raises
    ------
    InputError
        A number is outside of its range.
    """

    def __init__(
        self,
        noise: BatchNoise,
        names: Sequence[str],
        scenarios: int,
        lanes: int,
        cache: ObjectCache | None,
    ) -> None:
        check_below("first sample", noise.sample, _FARTHEST)
        self.names = frozenset(names)
        self._sample = int(noise.sample)
        numbers = _whole(noise)
        padded = np.empty(-(-scenarios // lanes) * lanes, np.int64)
        padded[:scenarios] = numbers
        padded[scenarios:] = padded[scenarios - 1]
        self._numbers = padded.reshape(-1, lanes)
        rows = [_row(name, noise.inputs[name]) for name in names]
        self._plan = np.array([noise.seed, *(entry for row in rows for entry in row)], np.int64)
        self._room = len(names) * CHUNK * lanes
        self._function = _function(lanes, cache)

    def after(self, samples: int) -> LaidNoise:
        """Return the noise of a run that begins so many samples later."""
        later = copy(self)
        later._sample += samples
        return later

    def for_a_thread(self) -> Further:
        """Return what gives a kernel its further arguments, with memory of its own for a chunk."""
        room = np.empty(self._room + _ALIGNMENT // 8)
        chunk = room[-room.ctypes.data % _ALIGNMENT // 8 :]

        def further(start: int, first: int) -> tuple[Sequence[int], Sequence[int]]:
            arrays = self._plan, self._numbers[start:], chunk
            addresses = [array.ctypes.data for array in arrays]
            return [self._function.address, *addresses], [self._sample + first]

        return further


@lru_cache(maxsize=8)
def _function(lanes: int, cache: ObjectCache | None) -> CompiledFunction:
    """Return the function for a number of lanes, which is that of all kernels."""
    code = Unprinted.by(noise_code, KernelForm(lanes, processor=host()))
    return CompiledFunction(code, NOISE, signature_of(*_SIGNATURE), cache)


def _whole(noise: BatchNoise) -> NDArray[np.int64]:
    """Return the numbers of scenarios as such."""
    found = np.asarray(noise.numbers)
    if found.dtype.kind not in "iu" or found.ndim > 1:
        raise InputError(
            "numbers of scenarios", noise.numbers, "a whole number, or one for each",
            "give whole numbers",
        )  # fmt: skip
    for extreme in int(found.min()), int(found.max()):
        seed_of(noise.seed, extreme)
    return found.astype(np.int64)


def _row(name: str, noise: InputNoise) -> tuple[int, ...]:
    """Return what a plan has of an input."""
    place = f"noise of {name}"
    check_below(f"{place}, stream", noise.stream, 32)
    check_below(f"{place}, first sample", noise.first, _FARTHEST)
    check_below(f"{place}, samples", noise.count, _FARTHEST)
    if not np.isfinite(noise.deviation):
        remedy = "give it in the unit of the input"
        raise InputError(f"{place}, deviation", noise.deviation, "a finite number", remedy)
    deviation = int(np.float64(noise.deviation).view(np.int64))
    return noise.stream, noise.first, noise.first + noise.count, deviation
