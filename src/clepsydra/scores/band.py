"""Scores of a level that loads must leave in its band: for how long it is outside, and how far.

Between samples the level moves on a straight line, as for the integral errors.
"""

from __future__ import annotations

from collections.abc import Callable

from clepsydra.scores.sample import Expression, Fold, Sample, larger, magnitude
from clepsydra.scores.score import Of, Score

_LEAST = 1e-300


def below(sample: Sample, level: Expression) -> Expression:
    """Return how far a level is below the band."""
    return larger(sample.band[0] - level, 0.0)


def above(sample: Sample, level: Expression) -> Expression:
    """Return how far a level is above the band."""
    return larger(level - sample.band[1], 0.0)


def share_outside(sample: Sample) -> Expression:
    """Return the share of a sample in which the level is outside.

    From a to b beyond an end, negative within, it is (max(a, 0) + max(b, 0))/(|a| + |b|).

    Examples
    --------
    >>> float(share_outside(Sample(before=0.5, now=1.0, band=(0.25, 0.75))))
    0.5
    """
    low, high = sample.band
    total = 0.0
    for a, b in (
        (sample.before - high, sample.now - high),
        (low - sample.before, low - sample.now),
    ):
        way = larger(magnitude(a) + magnitude(b), _LEAST)
        total = total + (larger(a, 0.0) + larger(b, 0.0)) / way
    return sample.of_load * total


def _largest(beyond: Callable[[Sample, Expression], Expression]) -> Callable[[Sample], Expression]:
    return lambda sample: (
        sample.of_load * larger(beyond(sample, sample.before), beyond(sample, sample.now))
    )


TIME_OUTSIDE = Score(
    "time_outside_band",
    "Time outside the band",
    "For how long loads drive the level out of its band, on either side.",
    Of.BAND,
    powers=(0, 1),
    wants="load",
    integrand=share_outside,
).registered()
ABOVE, BELOW = (
    Score(
        f"{side}_band",
        f"{side.capitalize()} the band",
        f"How far loads drive the level {side} its band.",
        Of.BAND,
        powers=(1, 0),
        wants="load",
        integrand=_largest(beyond),
        fold=Fold.LARGEST,
    ).registered()
    for side, beyond in (("above", above), ("below", below))
)
