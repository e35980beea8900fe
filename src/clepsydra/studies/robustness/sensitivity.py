"""What the scatter of a score comes from: Sobol indices with their intervals.

The estimators are those of `scipy.stats.sobol_indices`: the first-order index of A. Saltelli et al.
(Comput. Phys. Commun. 181, 2010, doi:10.1016/j.cpc.2009.09.018, table 2 (b)) and the total index of
Jansen (table 2 (f)). They are written here once more because SciPy's function takes only powers of
two of rows, which are no longer there when rows are left out, and its bootstrap draws without a
seed and evaluates every resample and every set with one row left out anew. Both estimators are
means over rows, divided by a variance that is made of such means: a resample is a product of how
often it has each row with one matrix, and leaving out a row is a subtraction.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clepsydra.base.words import with_minus
from clepsydra.studies.robustness.saltelli import SaltelliDesign
from clepsydra.studies.robustness.shares import LEVEL

#: With fewer rows that can be used there are no indices: their intervals would say nothing.
LEAST_ROWS = 64
#: Nor where more than this share of rows is left out: what remains is another question.
MOST_LEFT_OUT = 0.5
#: How many resamples an interval is made of, as SciPy has it.
RESAMPLES = 999
_TOGETHER = 128


@dataclass(frozen=True)
class SobolIndex:
    """An index with its interval.

    Examples
    --------
    >>> print(SobolIndex(0.314, 0.287, 0.341))
    31 % (29 to 34 %)
    """

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        value, low, high = (round(100.0 * x) for x in (self.value, self.low, self.high))
        return with_minus(f"{value} % ({low} to {high} %)")


@dataclass(frozen=True)
class Sensitivity:
    """What the scatter of one score comes from.

    Attributes
    ----------
    first : dict of str to SobolIndex
        By group: the share of the variance that would go, on average, if the group were known.
    total : dict of str to SobolIndex
        By group: the share that would stay, on average, if all but the group were known; above
        `first` where the group acts together with others.
    rows, left_out : int
        How many rows of the design were used, and in how many a score was infinite or no number.
        Such a row is left out as a whole, from A, from B and from every block; the indices are then
        about the loops that work.
    varies : bool
        False where all scores of A and B are equal; all indices are then 0.

    Examples
    --------
    >>> print(Sensitivity({}, {}, 10, 1014, True))
    unknown: of 1,024 rows, 1,014 have a draw without a finite score
    """

    first: dict[str, SobolIndex]
    total: dict[str, SobolIndex]
    rows: int
    left_out: int
    varies: bool

    @property
    def known(self) -> bool:
        """Whether there are indices; not where too many rows are left out."""
        return bool(self.total)

    def __str__(self) -> str:
        missing = (
            f"of {self.rows + self.left_out:,} rows, {self.left_out:,} have a draw without a "
            "finite score"
        )
        if not self.known:
            return f"unknown: {missing}"
        if not self.varies:
            return "the score does not vary"
        ordered = sorted(self.total, key=lambda name: -self.total[name].value)
        words = "; ".join(f"{name} {self.total[name]}" for name in ordered)
        return f"{words}; {missing}" if self.left_out else words


def sensitivities(
    design: SaltelliDesign, scores: Mapping[str, np.ndarray], level: float = LEVEL
) -> dict[str, Sensitivity]:
    """Return what the scatter of each score comes from.

    Intervals are bootstrap intervals, bias-corrected and accelerated, of the rows as if they were
    drawn at random (B. Efron, J. Am. Stat. Assoc. 82, 1987, doi:10.1080/01621459.1987.10478410).
    Rows of a Sobol sequence are spread more evenly: with 2048 and more the intervals are wider than
    need be. With a few hundred they may hold less often than the level, as 9 times in 10.

    Parameters
    ----------
    design : SaltelliDesign
    scores : mapping of str to ndarray [draws]
        By the score's name, one for each draw in the order of `design.unit_numbers()`; infinite or
        not a number where a loop broke or a draw is impossible.
    level : float

    Examples
    --------
    >>> design = SaltelliDesign({"area": (0,), "pump": (1,)}, rows=1024, seed=1)
    >>> area, pump = design.unit_numbers().T
    >>> found = sensitivities(design, {"peak": 3.0 * area + 4.0 * pump})["peak"]
    >>> print(found)
    pump 64 % (59 to 69 %); area 36 % (33 to 39 %)
    """
    return {name: _sensitivity(design, values, level) for name, values in scores.items()}


def _sensitivity(design: SaltelliDesign, values: np.ndarray, level: float) -> Sensitivity:
    blocks = np.asarray(values, dtype=float).reshape(-1, design.rows)
    if len(blocks) != len(design.groups) + 2:
        raise ValueError(f"{np.size(values)} scores for a design of {design.draws} draws")
    used = blocks[:, np.all(np.isfinite(blocks), axis=0)]
    rows = used.shape[1]
    left_out = design.rows - rows
    if rows < LEAST_ROWS or left_out > MOST_LEFT_OUT * design.rows:
        return Sensitivity({}, {}, rows, left_out, True)
    if not np.ptp(used[:2]):
        nothing = {name: SobolIndex(0.0, 0.0, 0.0) for name in design.groups}
        return Sensitivity(nothing, dict(nothing), rows, left_out, False)
    # No square overflows, and no mean far from zero takes the digits of the variance.
    shifted = np.ldexp(used, -int(np.frexp(np.max(np.abs(used)))[1]))
    shifted -= shifted[:2].mean()
    found = np.stack([_indices(_terms(shifted).mean(axis=0)), *_interval(shifted, design, level)])
    first, total = (
        {name: SobolIndex(*map(float, found[:, kind, n])) for n, name in enumerate(design.groups)}
        for kind in (0, 1)
    )
    return Sensitivity(first, total, rows, left_out, True)


def _terms(blocks: np.ndarray) -> np.ndarray:
    """Return of each row what the indices are means of [rows, 2 + 2 groups]."""
    first, second, mixed = blocks[0], blocks[1], blocks[2:]
    return np.concatenate(
        [
            [0.5 * (first + second), 0.5 * (first**2 + second**2)],
            second * (mixed - first),
            0.5 * (mixed - first) ** 2,
        ]
    ).T


def _indices(means: np.ndarray) -> np.ndarray:
    """Return the indices [..., 2, groups] from means of the terms [..., 2 + 2 groups]."""
    variance = means[..., 1] - means[..., 0] ** 2
    shares = means[..., 2:].reshape(*means.shape[:-1], 2, -1)
    scale = np.where(variance > 0.0, variance, np.inf)
    return shares / scale[..., None, None]


def _interval(
    blocks: np.ndarray, design: SaltelliDesign, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower and upper bounds of all indices [2, groups]."""
    from scipy.special import ndtr, ndtri

    terms = _terms(blocks)
    rows = len(terms)
    drawn = np.random.default_rng((design.seed, 1))
    resampled = []
    for start in range(0, RESAMPLES, _TOGETHER):
        count = min(_TOGETHER, RESAMPLES - start)
        picked = drawn.integers(0, rows, (count, rows)) + rows * np.arange(count)[:, None]
        weights = np.bincount(picked.ravel(), minlength=count * rows).reshape(count, rows)
        resampled.append(_indices(weights @ terms / rows))
    spread = np.concatenate(resampled)
    mean = terms.mean(axis=0)
    # Efron's equations (6.5) and (6.6), with the acceleration from leaving out each row.
    below = 0.5 * ((spread < _indices(mean)).mean(0) + (spread <= _indices(mean)).mean(0))
    inside = 0.5 / RESAMPLES
    bias = ndtri(np.clip(below, inside, 1.0 - inside))
    without = _indices((rows * mean - terms) / (rows - 1))
    lean = without.mean(axis=0) - without
    scale = np.sum(lean**2, axis=0) ** 1.5
    acceleration = np.sum(lean**3, axis=0) / np.where(scale > 0.0, 6.0 * scale, np.inf)
    bounds = []
    for tail in (ndtri(0.5 - 0.5 * level), ndtri(0.5 + 0.5 * level)):
        chance = ndtr(bias + (bias + tail) / (1.0 - acceleration * (bias + tail)))
        ordered = np.sort(spread, axis=0)
        place = chance * (RESAMPLES - 1)
        low = np.floor(place).astype(int)
        high = np.minimum(low + 1, RESAMPLES - 1)
        lower, upper = (np.take_along_axis(ordered, at[None], 0)[0] for at in (low, high))
        bounds.append(lower + (place - low) * (upper - lower))
    return bounds[0], bounds[1]
