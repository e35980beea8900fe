"""What polynomial designs share: the sampled models of paired loops, and how fast to ask them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.designs.applicability import reasons_about
from clepsydra.designs.loops.control_authority import check_ranges, largest_proportional_gain
from clepsydra.designs.loops.pairing import Pairing, checked_pairing
from clepsydra.designs.models.transfer_element import moving_element
from clepsydra.designs.polynomial.element_sampling import sampled_element
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial.spectral_factor import spectral_factor
from clepsydra.designs.polynomial.two_degree_of_freedom import Characteristic, assigned
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint


class ModelledPair(NamedTuple):
    """One pair: measurement, input, the sampled model between them, and the input at rest.

    Examples
    --------
    >>> pair = ModelledPair(Signal("level", "V", low=0.0, high=10.0),
    ...                     Signal("pump", "V", low=0.0, high=10.0),
    ...                     SampledModel((0.1,), (-0.9,), 0, 1.0), 3.0)
    >>> pair.words, round(pair.usual_penalty, 6)
    ('level by pump', 0.111111)
    """

    output: Signal
    input: Signal
    model: SampledModel
    resting_input: float

    @property
    def words(self) -> str:
        """The pair as the reader sees it."""
        return f"{self.output.name} by {self.input.name}"

    @property
    def usual_penalty(self) -> float:
        """q_u by Bryson's rule: (a tenth of the output's range / the room of the input)²."""
        room = largest_proportional_gain(self.output, self.input, self.resting_input)
        return float(room**-2)


def modelled_pairs(
    model: LinearModel, pairing: Pairing | None, given: Sequence[SampledModel] | None
) -> tuple[OperatingPoint, list[ModelledPair]]:
    """Return the operating point and the pairs with their sampled models.

    Parameters
    ----------
    pairing : sequence of (output, input), mapping, or None
        The one that the relative gains suggest for None.
    given : sequence of SampledModel, optional
        One for each pair, an identified one say; without them the paired elements are sampled
        (`designs.polynomial.element_sampling`).

    Raises
    ------
    NotApplicable
        A signal has no range, an input does not move its output, or an element has no sampled
        model of second order.
    InputError
        The model has no operating point, the pairing is no pairing of the model, or the given
        models are not one for each pair, at the sampling period of the process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("eight-tanks").analysis
    >>> _, (pair,) = modelled_pairs(analysis.model, analysis.pairing, None)
    >>> pair.model.delay, round(pair.model.static_gain / 60, 4)
    (7, 3.08)
    """
    period = check_sampling_period(model)
    point = operating_point_of(model)
    outputs, inputs = checked_pairing(pairing, model)
    process, at = point.process, point.as_dict()
    check_ranges(process, outputs, inputs)
    models = _sampled(model, outputs, inputs, period) if given is None else list(given)
    if len(models) != len(outputs):
        raise InputError(
            "models", len(models), f"{len(outputs)} models, one for each pair",
            "give them in the order of the pairing",
        )  # fmt: skip
    for each in models:
        if not isinstance(each, SampledModel) or abs(each.period / period - 1.0) > 1e-9:
            raise InputError(
                "models", getattr(each, "period", each),
                f"sampled models of the process's sampling period of {period:g} s",
                "identify or sample with this period",
            )  # fmt: skip
    return point, [
        ModelledPair(process.signal(y), process.signal(u), each, at[u])
        for y, u, each in zip(outputs, inputs, models, strict=True)
    ]


def _sampled(
    model: LinearModel, outputs: Sequence[str], inputs: Sequence[str], period: float
) -> list[SampledModel]:
    found = []
    for output, name in zip(outputs, inputs, strict=True):
        element = moving_element(model, output, name)
        with reasons_about(f"{output} by {name}"):
            found.append(sampled_element(element, period))
    return found


class Request(NamedTuple):
    """What a user asked for of all loops; None for what the design is to choose.

    Examples
    --------
    >>> Request(10.0, (0.5,)).is_open
    False
    """

    penalty: float | None
    assigned_poles: Sequence[float] | None

    @property
    def is_open(self) -> bool:
        """Whether nothing is asked for."""
        return self.penalty is None and self.assigned_poles is None

    def in_words(self) -> str:
        """Return it as a reader sees it."""
        words = [] if self.penalty is None else [f"q_u = {self.penalty:.4g}"]
        if self.assigned_poles is not None:
            words.append("γ = " + ", ".join(f"{pole:.4g}" for pole in self.assigned_poles))
        return " and ".join(words)


def characteristic(
    pair: ModelledPair, request: Request, factor: float, numerator: np.ndarray
) -> tuple[Characteristic, float, tuple[float, ...]]:
    """Return D of a pair, slower by a factor, with its q_u and its assigned poles.

    q_u grows with the square of the factor, and an assigned pole γ becomes γ^(1/factor). Where
    no poles are asked for there is one for each pole of the spectral factor, as fast as that.

    Parameters
    ----------
    factor : float
        From 1 on.
    numerator : ndarray
        B as far as it is factorised; its delay does not count.

    Examples
    --------
    >>> pair = ModelledPair(Signal("level", "V", low=0.0, high=10.0),
    ...                     Signal("pump", "V", low=0.0, high=10.0),
    ...                     SampledModel((0.1,), (-0.9,), 0, 1.0), 3.0)
    >>> D, penalty, poles = characteristic(pair, Request(None, None), 1.0, pair.model.B)
    >>> [round(d, 4) for d in D.coefficients], round(poles[0], 4)
    ([1.0, -1.4352, 0.515], 0.7176)
    """
    penalty = pair.usual_penalty if request.penalty is None else request.penalty
    penalty *= factor**2
    found = spectral_factor(tuple(pair.model.A), tuple(numerator), penalty)
    if request.assigned_poles is None:
        fast = [abs(pole) for pole in found.poles][: pair.model.order]
    else:
        fast = list(request.assigned_poles)
    poles = tuple(pole ** (1.0 / factor) if pole else 0.0 for pole in fast)
    return assigned(found, poles), penalty, poles
