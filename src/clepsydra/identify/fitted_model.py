"""A model as it was fitted to one output, with everything that speaks for and against it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.identify.control_settings import ControlSettings
from clepsydra.identify.estimate import Estimate
from clepsydra.identify.residual_tests import ResidualTests


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A model of one output by one input.

    Parameters
    ----------
    name, title, formula : str
        "FOPDT", "first order plus dead time", and its transfer function.
    estimates : tuple of Estimate
    parameters : int
        How many the dynamics have; rest and initial motion do not count.
    simulated : ndarray [N]
        Output over the whole record, from the inputs alone.
    residuals : ndarray
        Measured less modelled, of the last samples before the held-back third.
    tests : ResidualTests
    widening : float
        How much the colour of the residuals widened the intervals, at most.
    fit, validated : float
        Fit to the first two thirds and to the held-back third [%].
    settings : ControlSettings or None
        Of a controller for it; None where no rule takes such a model.
    remarks : tuple of str
        What speaks against it.

    Examples
    --------
    See `clepsydra.identify.transfer_model.transfer_model`.
    """

    name: str
    title: str
    formula: str
    estimates: tuple[Estimate, ...]
    parameters: int
    simulated: np.ndarray
    residuals: np.ndarray
    tests: ResidualTests
    widening: float
    fit: float
    validated: float
    settings: ControlSettings | None
    remarks: tuple[str, ...] = ()

    @property
    def is_told(self) -> bool:
        """Whether the record tells every parameter."""
        return not self.remarks

    def as_dict(self) -> dict[str, Any]:
        """Return what was found, for JSON."""
        return {
            "name": self.name,
            "title": self.title,
            "formula": self.formula,
            "estimates": [estimate.as_dict() for estimate in self.estimates],
            "fit": self.fit,
            "validated_fit": self.validated,
            "whiteness": self.tests.whiteness,
            "independence": self.tests.independence,
            "residuals": self.tests.words,
            "widening": self.widening,
            "settings": None if self.settings is None else self.settings.as_dict(),
            "remarks": list(self.remarks),
        }
