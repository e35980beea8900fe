"""The gains of a law in increments, and the controller of paired loops that they make."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.polynomial_controller import PolynomialShape
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.gain_units import percent_gain
from clepsydra.designs.loops.loops_together import LoopsTogether
from clepsydra.designs.polynomial.paired_models import ModelledPair
from clepsydra.designs.polynomial.two_degree_of_freedom import TwoDegreeOfFreedom
from clepsydra.designs.slowing_down import OF_STATE_FEEDBACK, note_on_peak, note_on_slowing
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.program.step_law import StepLaw


class LoopGains(NamedTuple):
    """The gains of one loop, see `controllers.polynomial_controller.polynomial_law`.

    Parameters
    ----------
    error : float
        r0 [input unit / output unit]
    measurement, setpoint : tuple of float
        g1, g2, … and s1, s2, …
    increment : tuple of float
        p1, p2, … [1]
    words : str
        How they were found.

    Examples
    --------
    >>> LoopGains(0.1, (2.0,), (), (), "by hand").shape
    PolynomialShape(measurement_gains=1, setpoint_gains=0, increment_gains=0)
    """

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


def of_two_degrees(found: TwoDegreeOfFreedom, words: str) -> LoopGains:
    """Return the gains of a polynomial controller.

    Examples
    --------
    >>> from clepsydra.designs.polynomial.diophantine import rational
    >>> pi = TwoDegreeOfFreedom(rational([1]), rational([2.125, -2.0]), 0.125)
    >>> of_two_degrees(pi, "by hand").measurement
    (2.0,)
    """
    return LoopGains(found.reference_gain, found.difference_gains, (), found.increment_gains, words)


class PairedDesign(NamedTuple):
    """What a design of paired loops needs to make its controller.

    Parameters
    ----------
    fixed : mapping
        Parameters that no slowing down changes; the limits are added.
    gains_at : callable
        A factor from 1 on to the gains of all loops, slower by it.
    """

    name: str
    family: str
    model: LinearModel
    point: OperatingPoint
    pairs: Sequence[ModelledPair]
    law: StepLaw
    fixed: Mapping[str, float]
    gains_at: Callable[[float], list[LoopGains]]

    def controller(self, source: str, notes: Sequence[str], given: str) -> Controller:
        """Return the controller, at rest at the operating point.

        Where nothing is given all loops are slowed down by one factor until together they have a
        sensitivity peak of 2; what a user asked for is used as it is.

        Parameters
        ----------
        source : str
            How the gains were found.
        given : str
            What was asked for; empty for nothing.

        Raises
        ------
        NotApplicable
            The loops together are unstable, or cannot be made robust, a dead time leaves no
            sampled loop, or a gain is outside of what a controller takes.
        """
        first = self.gains_at(1.0)
        fixed = {**numbers_at(self.point, self.law.parameters), **self.fixed}
        values = fixed | self._values(first)
        blank = controller_at(self.point, self.name, self.family, self.law, values)
        loops = LoopsTogether(blank, self.model, self._values, OF_STATE_FEEDBACK)
        if given:
            found = loops.as_given(first, f"{given}; ask for less")
            more = note_on_peak(found.peak, "choose a larger q_u or slower assigned poles")
        else:
            found = loops.slowed_down(self.gains_at)
            more = note_on_slowing(found, "the controller")
        words = "; ".join(
            f"{pair.words}: {loop.words}, gain on a sudden rise "
            f"{percent_gain(_sudden(loop), pair.output, pair.input):.3g} %/%"
            for pair, loop in zip(self.pairs, found.design, strict=True)
        )
        period = self.point.process.sampling_period
        holds = f"Its gains hold for a sampling period of {period:g} s and no other."
        made = loops.made(found, f"{source}: {words}", (*notes, *more, holds))
        return dataclasses.replace(made, initial_state=_zeroed(made.initial_state))

    def _values(self, gains: Sequence[LoopGains]) -> dict[str, float]:
        values: dict[str, float] = {}
        for loop, pair in zip(gains, self.pairs, strict=True):
            values |= loop.values(pair.output)
        return values


def _zeroed(state: dict[str, float]) -> dict[str, float]:
    """Return the state with minus zeros as zeros."""
    return {name: value + 0.0 for name, value in state.items()}


def _sudden(gains: LoopGains) -> float:
    return gains.error + (gains.measurement[0] if gains.measurement else 0.0)
