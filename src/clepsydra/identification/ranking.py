"""Which of the models of one output is the one to use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.identification.fitted_model import FittedModel
from clepsydra.identification.residual_tests import SIGNIFICANT, chance_of_no_effect
from clepsydra.identification.validation import EQUAL, USEFUL

RANKING_RULE = (
    "Every model is fitted to the first two thirds of the record and simulated on through the "
    "last third from the inputs alone, without a single measured value of it. The fit is "
    "100 % − the error there in percent of the error of a constant, the mean of the first two "
    "thirds. A model is of use where that fit is 10 % or more, where an F test finds that the "
    "input explains what the output does not do by itself (of coloured residuals, the last third "
    "has to confirm it by 10 %), where the sign of the gain is told, and where nothing else is "
    "more than ten times as strong. Models of use up to ten points behind the best whose "
    "parameters the record tells stand before all others: of these first those that it tells and "
    "whose residuals pass the tests, then those that agree with them in the sign of the gain. Of "
    "equals within one point of the best, the one with the fewest parameters comes first."
)


def ranked(models: Sequence[FittedModel]) -> tuple[FittedModel, ...]:
    """Return the models, the one to use first."""
    useful = [model for model in models if model.doubt is None]
    told = [model for model in useful if model.is_told] or useful
    fitting = [m for m in useful if _fit(m) >= max(map(_fit, told)) - USEFUL]
    white = [m for m in fitting if m.settings and m.tests.white and m.tests.independent]

    def passes(model: FittedModel) -> bool:
        if model.tests.white or not model.tests.independent:
            return model.tests.independent
        # Whatever structure is right leaves the noise of the plant. Where one that explains more
        # leaves it white, what colours the residuals of this one is dynamics that it lacks.
        return model.settings is not None and not any(_explains_more(m, model) for m in white)

    signed = sorted((m for m in fitting if m.sign), key=lambda m: (passes(m), _fit(m)))
    sign = signed[-1].sign if signed else 0

    def standing(model: FittedModel) -> tuple[bool, ...]:
        return (
            model in fitting,
            model.doubt is None,
            # A second lag of which there is no trace explains nothing, whatever a test says.
            passes(model) and model.is_told,
            model.sign in (0, sign),
            model.is_told,
        )

    left = sorted(models, key=_fit, reverse=True)
    order: list[FittedModel] = []
    while left:
        best = max(standing(model) for model in left)
        group = [model for model in left if standing(model) == best]
        top = max(model.validated for model in group)
        equal = [m for m in group if not m.validated < top - EQUAL]
        first = min(equal, key=lambda model: (model.parameters, -model.validated))
        order.append(first)
        left.remove(first)
    return tuple(order)


def _fit(model: FittedModel) -> float:
    """Return the fit to the part of the record where it is worse [%]."""
    return float(np.nan_to_num(min(model.validated, model.fit), nan=-np.inf))


def _explains_more(model: FittedModel, than: FittedModel) -> bool:
    """Return whether an F test prefers a transfer function to another."""
    further = max(1, model.parameters - than.parameters)
    chance = chance_of_no_effect(
        than.residuals, model.residuals, further=further, parameters=model.parameters + 2
    )
    return chance < SIGNIFICANT
