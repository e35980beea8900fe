"""A model as it was fitted to one output, with everything that speaks for and against it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.identification.control_settings import ControlSettings
from clepsydra.identification.estimate import Estimate
from clepsydra.identification.residual_tests import SIGNIFICANT, ResidualTests
from clepsydra.identification.validation import USEFUL

OUTWEIGHED = "something else is more than ten times as strong as all that the input did"


@dataclass(frozen=True, eq=False, repr=False)
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
    beyond : float
        How much better it tells the held-back third than what the output does by itself [%].
    chance : float
        Probability that an input without any effect explains as much of the first two thirds.
    settings : ControlSettings or None
        Of a controller for it; None where no rule takes such a model.
    remarks : tuple of str
        What speaks against it.
    outweighed : bool
        Whether something else moves the output more than ten times as strongly as all that the
        input did.
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
    beyond: float
    chance: float
    settings: ControlSettings | None
    remarks: tuple[str, ...] = ()
    outweighed: bool = False

    def __repr__(self) -> str:
        return f"{self.name}: {self.numbers or self.title}; fit {self.validated:.1f} % held back"

    @property
    def numbers(self) -> str:
        """What it says of the process, with units."""
        words = []
        for estimate in self.estimates:
            name = estimate.signal.description
            if estimate.signal.unit == "s":
                words.append(f"{name} {time_text(estimate.value)}")
            elif estimate.signal.name in ("gain", "slope", "balance"):
                shown = f"{estimate.shown[0]:.3g}".replace("-", "−")
                words.append(f"{name} {shown} {estimate.signal.shown_unit}".removesuffix(" 1"))
        return ", ".join(words)

    @property
    def is_told(self) -> bool:
        """Whether the record tells every parameter."""
        return not self.remarks

    @property
    def doubt(self) -> str | None:
        """Why it should not be used at all; None where nothing says so."""
        if not self.validated >= USEFUL:
            return "on the held-back third it is hardly better than a constant"
        # The F test is exact for white residuals; of others it rests on their noise model, and the
        # samples that no fit has seen have to confirm it.
        confirmed = self.tests.white or self.beyond >= USEFUL
        if not (self.chance < SIGNIFICANT and confirmed):
            return "the input explains nothing that the output does not do by itself"
        if self.outweighed:
            return OUTWEIGHED
        if self.sign == 0 and self._gain is not None:
            return "the record does not tell the sign of its gain"
        return None

    @property
    def cautions(self) -> tuple[str, ...]:
        """All that speaks against it: its doubt, and its remarks."""
        return (*([] if self.doubt is None else [self.doubt]), *self.remarks)

    @property
    def sign(self) -> int:
        """Of its gain: 1 or −1, and 0 where there is none or the record does not tell it."""
        if self._gain is None or not self._gain.is_told:
            return 0
        return 1 if self._gain.value > 0.0 else -1

    @property
    def _gain(self) -> Estimate | None:
        names = ("gain", "slope")
        return next((each for each in self.estimates if each.signal.name in names), None)

    def as_dict(self) -> dict[str, Any]:
        """Return what was found, for JSON."""
        return {
            "name": self.name,
            "title": self.title,
            "formula": self.formula,
            "estimates": [estimate.as_dict() for estimate in self.estimates],
            "fit": self.fit,
            "validated_fit": self.validated,
            "fit_beyond_the_output_alone": self.beyond,
            "chance_of_no_effect": self.chance,
            "doubt": self.doubt,
            "whiteness": self.tests.whiteness,
            "independence": self.tests.independence,
            "residuals": self.tests.words,
            "widening": self.widening,
            "settings": None if self.settings is None else self.settings.as_dict(),
            "remarks": list(self.remarks),
        }
