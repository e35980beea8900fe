"""Between which values a level stays: what a tuning may limit, and no score of a run."""

from __future__ import annotations

from clepsydra.scores.sample import BEYOND, Expression, Fold, Sample, larger, where
from clepsydra.scores.score import Of, Score


def _highest_under_load(sample: Sample) -> Expression:
    return where(sample.of_load > 0.0, larger(sample.before, sample.now), -BEYOND)


def _lowest_under_load(sample: Sample) -> Expression:
    return where(sample.of_load > 0.0, -larger(-sample.before, -sample.now), BEYOND)


_ENDS = (
    ("highest", Fold.LARGEST, _highest_under_load),
    ("lowest", Fold.SMALLEST, _lowest_under_load),
)
_OF_RUN = [
    Score(
        end,
        f"{end.capitalize()} level",
        f"The {end} level of the run.",
        Of.LEVEL,
        powers=(1, 0),
        smaller_is_better=fold is Fold.LARGEST,
        integrand=lambda sample: sample.now,
        fold=fold,
    )
    for end, fold, _ in _ENDS
]
_UNDER_LOAD = [
    Score(
        f"{end}_under_load",
        f"{end.capitalize()} level under load",
        f"The {end} level during load steps, of a level with a band.",
        Of.BAND,
        powers=(1, 0),
        smaller_is_better=fold is Fold.LARGEST,
        wants="load",
        integrand=integrand,
        fold=fold,
    )
    for end, fold, integrand in _ENDS
]
EXTREME_LEVELS = {score.key: score for score in (*_OF_RUN, *_UNDER_LOAD)}
