"""What is kept of the scores of many draws, in parts that merge in any order."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.studies.robustness.exact_sum import ExactSum
from clepsydra.studies.robustness.extremes import Extreme, Extremes
from clepsydra.studies.robustness.quantiles import Quantile, places
from clepsydra.studies.robustness.shares import LEVEL
from clepsydra.studies.robustness.sketch import RELATIVE_ERROR, Sketch, steps_for

#: So many scores are kept as they are, in 8 MB; of more, a sketch.
KEPT = 1_000_000
#: Of what is saved; its digest comes first, of so many bytes.
_FORMAT = 1
_DIGEST = 32


@dataclass(frozen=True, eq=False)
class Distribution:
    """The scores of many draws: their quantiles, extremes, mean and variance.

    Up to `kept` scores it has them all and its quantiles are exact; with one more it has a
    `Sketch`, whose quantiles are within the relative error. Which of both depends on the number of
    scores alone, and extremes and sums are exact, so any order of merging, and any division among
    workers, gives the same bits.

    Attributes
    ----------
    scores : ndarray [n] or None
        All of them, ascending; None where there are more than `kept`.
    sketch : Sketch or None
        Where they are not kept.
    extremes : Extremes
        With the number of the draw of each.
    sums : ExactSum
        Mean and variance; `sums.of_finite()` has those of the loops that did not break.
    kept : int
    steps : int
        As `Sketch` has it.

    Examples
    --------
    >>> parts = [Distribution.of(np.arange(n, n + 500.0), np.arange(n, n + 500)) for n in (500, 0)]
    >>> both = parts[0].merged(parts[1])
    >>> print(both.quantile(0.95))
    95 % of draws at or below 949 (935 to 963)
    >>> both.count, both.sums.mean, both.extremes.worst()
    (1000, 499.5, Extreme(value=999.0, draw=999))
    """

    scores: np.ndarray | None
    sketch: Sketch | None
    extremes: Extremes
    sums: ExactSum
    kept: int
    steps: int

    @classmethod
    def of(
        cls,
        scores: np.ndarray,
        draws: np.ndarray | None = None,
        kept: int = KEPT,
        relative_error: float = RELATIVE_ERROR,
    ) -> Distribution:
        """Return what is kept of scores.

        Parameters
        ----------
        scores : ndarray [n]
            Infinite where a loop broke.
        draws : ndarray of int [n], optional
            The number of each draw, in any order; 0, 1, 2, … without it.
        kept : int
            How many scores are kept as they are.
        relative_error : float
            Of quantiles where there are more.

        Raises
        ------
        InputError
            There are no scores, one is not a number, or the relative error is out of its range.
        """
        extremes = Extremes.of(scores, draws)
        ordered = np.sort(np.asarray(scores, dtype=float) + 0.0)  # no zero with a sign
        alone = cls(ordered, None, extremes, ExactSum.of(ordered), kept, steps_for(relative_error))
        return alone if len(ordered) <= kept else alone._sketched()

    @property
    def count(self) -> int:
        """How many scores there are."""
        return self.sums.count

    @property
    def relative_error(self) -> float:
        """What a quantile is off by, at most; 0 where all scores are kept."""
        return 0.0 if self.sketch is None else self.sketch.relative_error

    def merged(self, *others: Distribution) -> Distribution:
        """Return what is kept of all their scores; merge many at once, not one by one."""
        every = (self, *others)
        if any((each.kept, each.steps) != (self.kept, self.steps) for each in every):
            raise ValueError("distributions with different settings do not merge")
        extremes, sums = self.extremes, self.sums
        for each in others:
            extremes, sums = extremes.merged(each.extremes), sums.merged(each.sums)
        if sums.count <= self.kept:
            ordered = np.sort(np.concatenate([each.scores for each in every]))
            return Distribution(ordered, None, extremes, sums, self.kept, self.steps)
        sketches = [each._as_sketch() for each in every]
        sketch = sketches[0].merged(*sketches[1:])
        return Distribution(None, sketch, extremes, sums, self.kept, self.steps)

    def at(self, place: int) -> float:
        """Return the score at a place of the ascending order, counted from 1."""
        if self.scores is not None:
            return float(self.scores[place - 1])
        ends = {1: self.extremes.least.value, self.count: self.extremes.largest.value}
        if place in ends:
            return ends[place]
        return min(max(self._as_sketch().at(place), ends[1]), ends[self.count])

    def quantile(self, chance: float, level: float = LEVEL) -> Quantile:
        """Return a quantile with its interval, as `quantiles.quantile` does."""
        found = places(self.count, chance, level)
        low, high = (None if p is None else self.at(p) for p in (found.low, found.high))
        return Quantile(chance, self.at(found.quantile), low, high, self.count, level)

    def as_bytes(self) -> bytes:
        """Return it as bytes to save: a digest and a NumPy file; equal ones give equal bytes.

        Examples
        --------
        >>> one = Distribution.of(np.array([1.0, 2.0]))
        >>> Distribution.from_bytes(one.as_bytes()).as_bytes() == one.as_bytes()
        True
        """
        least, largest, sums = self.extremes.least, self.extremes.largest, self.sums
        arrays: dict[str, np.ndarray] = {
            "format": np.array([_FORMAT, self.kept, self.steps]),
            "extremes": np.array([least.value, largest.value]),
            "draws": np.array([least.draw, largest.draw], dtype=np.int64),
            "counts_of_sum": np.array([sums.count, sums.above, sums.below]),
            "total": _digits(sums.total),
            "squares": _digits(sums.squares),
        }
        if self.sketch is None:
            arrays["scores"] = np.asarray(self.scores)
        else:
            arrays |= {"buckets": self.sketch.buckets, "counts": self.sketch.counts}
        file = io.BytesIO()
        np.savez(file, **arrays)  # type: ignore[arg-type]
        return hashlib.sha256(file.getvalue()).digest() + file.getvalue()

    @classmethod
    def from_bytes(cls, saved: bytes) -> Distribution:
        """Return a saved one.

        Raises
        ------
        InputError
            The bytes are damaged, of something else, or of another version of Clepsydra.
        """
        digest, content = saved[:_DIGEST], saved[_DIGEST:]
        if hashlib.sha256(content).digest() != digest:
            raise _unreadable("damaged bytes")
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            return _read({name: file[name] for name in file.files})

    def _as_sketch(self) -> Sketch:
        """Return the sketch, made of the scores where they are kept."""
        if self.sketch is not None:
            return self.sketch
        assert self.scores is not None
        return Sketch.of_steps(self.scores, self.steps)

    def _sketched(self) -> Distribution:
        return Distribution(
            None, self._as_sketch(), self.extremes, self.sums, self.kept, self.steps
        )


def _read(arrays: Mapping[str, np.ndarray]) -> Distribution:
    """Return what saved arrays say."""
    version, kept, steps = arrays["format"].tolist()
    if version != _FORMAT:
        raise _unreadable(f"format {version}")
    values, draws = arrays["extremes"].tolist(), arrays["draws"].tolist()
    count, above, below = arrays["counts_of_sum"].tolist()
    sketched = "scores" not in arrays
    return Distribution(
        None if sketched else np.asarray(arrays["scores"], dtype=float),
        Sketch(steps, arrays["buckets"], arrays["counts"]) if sketched else None,
        Extremes(*(Extreme(*pair) for pair in zip(values, draws, strict=True))),
        ExactSum(count, _number(arrays["total"]), _number(arrays["squares"]), above, below),
        kept,
        steps,
    )


def _unreadable(what: str) -> InputError:
    return InputError(
        "saved distribution", Finding(what), "what `as_bytes` wrote", "run these draws again"
    )


def _digits(number: int) -> np.ndarray:
    """Return a whole number of any size as bytes."""
    size = number.bit_length() // 8 + 1
    return np.frombuffer(number.to_bytes(size, "little", signed=True), dtype=np.uint8)


def _number(digits: np.ndarray) -> int:
    return int.from_bytes(digits.astype(np.uint8).tobytes(), "little", signed=True)
