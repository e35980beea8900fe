"""Between which values a level stays: what a tuning may limit, and no score of a run."""

from __future__ import annotations

from clepsydra.scores.sample import Fold
from clepsydra.scores.score import Of, Score

EXTREME_LEVELS = {
    key: Score(
        key,
        f"{key.capitalize()} level",
        f"The {key} level of the run.",
        Of.LEVEL,
        powers=(1, 0),
        smaller_is_better=fold is Fold.LARGEST,
        integrand=lambda sample: sample.now,
        fold=fold,
    )
    for key, fold in (("highest", Fold.LARGEST), ("lowest", Fold.SMALLEST))
}
