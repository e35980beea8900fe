"""The pairs of a polynomial controller with their sampled models, and the gains of each loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers.polynomial_controller import PolynomialShape
from clepsydra.designs.applicability import reasons_about
from clepsydra.designs.loops.pairing import PairedLoop, Pairing, paired_loops
from clepsydra.designs.polynomial.element_sampling import sampled_element
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial.spectral_factor import spectral_factor
from clepsydra.designs.polynomial.two_degree_of_freedom import assigned, two_degree_of_freedom
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.linear.linear_model import LinearModel


@dataclass(frozen=True, eq=False)
class ModelledPair(PairedLoop):
    """A pair with the sampled model between its measurement and its input."""

    sampled: SampledModel

    @property
    def usual_penalty(self) -> float:
        """q_u by Bryson's rule: (a tenth of the output's range / the room of the input)²."""
        return float(self.largest_gain**-2)


def modelled_pairs(
    model: LinearModel, pairing: Pairing | None, given: Sequence[SampledModel] | None
) -> list[ModelledPair]:
    """Return the pairs with their sampled models.

    Parameters
    ----------
    given : sequence of SampledModel, optional
        One for each pair; from the linear model if left out.

    Raises
    ------
    NotApplicable
        An input does not move its output, a model cannot be sampled, or a signal has no finite
        range.
    InputError
        The pairing is no pairing of the model, the given models are none of its sampling period,
        or that is too long.
    """
    period = check_sampling_period(model)
    loops = paired_loops(model, pairing)
    if given is not None:
        expected = "a list of sampled models"
        require_type(given, (list, tuple), "models", expected, "give one for each pair, in a list")
    models = [_sampled(loop, period) for loop in loops] if given is None else list(given)
    if len(models) != len(loops):
        expected = f"{len(loops)} models, one for each pair"
        raise InputError("models", len(models), expected, "give them in the order of the pairing")
    for each in models:
        if not isinstance(each, SampledModel) or abs(each.period / period - 1.0) > 1e-9:
            expected = f"sampled models of the process's sampling period of {period:g} s"
            wrong = getattr(each, "period", each)
            raise InputError("models", wrong, expected, "identify or sample with this period")
    return [
        ModelledPair(loop.output, loop.input, model, loop.resting_input, loop.others, each)
        for loop, each in zip(loops, models, strict=True)
    ]


def _sampled(loop: PairedLoop, period: float) -> SampledModel:
    element = loop.element
    with reasons_about(loop.pair):
        return sampled_element(element, period)


class Request(NamedTuple):
    """What a user asked for of all loops; None for what the design is to choose."""

    penalty: float | None
    assigned_poles: Sequence[float] | None

    def in_words(self) -> str:
        """Return it as a reader sees it, empty where nothing is asked for."""
        words = [] if self.penalty is None else [f"q_u = {self.penalty:.4g}"]
        if self.assigned_poles is not None:
            words.append("γ = " + ", ".join(f"{pole:.4g}" for pole in self.assigned_poles))
        return " and ".join(words)


class LoopGains(NamedTuple):
    """The gains of one loop, see `controllers.polynomial_controller.polynomial_law`, in words."""

    error: float
    measurement: tuple[float, ...]
    setpoint: tuple[float, ...]
    increment: tuple[float, ...]
    words: str

    @property
    def shape(self) -> PolynomialShape:
        """How many there are of each."""
        return PolynomialShape(len(self.measurement), len(self.setpoint), len(self.increment))

    def values(self, measured: Signal) -> dict[str, float]:
        """Return the law's parameters of the loop of a measurement."""
        found = {path(measured, "reference_gain"): self.error}
        for what in ("measurement", "setpoint", "increment"):
            gains = getattr(self, what)
            names = elements(path(measured, f"{what}_gain"), len(gains))
            found |= dict(zip(names, gains, strict=True))
        return found


def polynomial_gains(
    pair: ModelledPair, request: Request, factor: float, B: tuple[float, ...]
) -> LoopGains:
    """Return the gains of two degrees of freedom for A of a pair and B, slower by a factor.

    The penalty is multiplied by the square of the factor, and assigned poles are taken to its
    inverse power. Where none are asked for, those of the spectral factor stand twice.

    Raises
    ------
    InputError
        A and B share a root.
    """
    sampled = pair.sampled
    penalty = pair.usual_penalty if request.penalty is None else request.penalty
    penalty *= factor**2
    found = spectral_factor(tuple(sampled.A), tuple(sampled.B), penalty)
    fast = request.assigned_poles
    if fast is None:
        fast = [abs(pole) for pole in found.poles][: sampled.order]
    poles = tuple(pole ** (1.0 / factor) if pole else 0.0 for pole in fast)
    try:
        solved = two_degree_of_freedom(tuple(sampled.A), B, assigned(found, poles))
    except InputError as refusal:
        place = f"{pair.pair}, {refusal.place}"
        raise InputError(place, refusal.value, refusal.expected, refusal.remedy) from None
    shown = ", ".join(dict.fromkeys(f"{pole:.4g}" for pole in poles))
    words = f"q_u = {penalty:.4g}, γ = {shown or 'none'}"
    gains = solved.reference_gain, solved.difference_gains, (), solved.increment_gains
    return LoopGains(*gains, words)
