"""How far from its setpoint an output is, with its sign: what a batch is judged by."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.scores.iae import SIGNED_ERROR
from clepsydra.scores.sample import Fold
from clepsydra.scores.score import Score

_INTEGRAL = replace(SIGNED_ERROR, key="error_integral")
_EXTREMES = [
    Score(
        f"{end}_error",
        f"{end.capitalize()} error",
        f"The {end} value of setpoint minus output.",
        powers=(1, 0),
        smaller_is_better=fold is Fold.LARGEST,
        integrand=lambda sample: sample.last,
        fold=fold,
    )
    for end, fold in (("highest", Fold.LARGEST), ("lowest", Fold.SMALLEST))
]
ERROR_EXTREMES = {score.key: score for score in (_INTEGRAL, *_EXTREMES)}
