"""LQI by Bryson's rule, whatever tells it the state, slowed down until its loop is robust."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.loops.control_authority import check_ranges
from clepsydra.designs.slowing_down import SlowedDown, note_on_slowing, slow_down
from clepsydra.designs.states.bryson_rule import Deviations
from clepsydra.designs.states.estimation import Estimation
from clepsydra.designs.states.linear_quadratic import (
    LqiGains,
    lqi_gains,
    slowest_time_constant,
)
from clepsydra.designs.states.measured_states import of_measurements
from clepsydra.designs.states.state_controllers import lqi_controller, sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.process import Process


class FoundLqi(NamedTuple):
    """An LQI controller, its gains, and the deviations that they were asked to keep to."""

    controller: Controller
    gains: LqiGains
    asked: Deviations


class StateLqi(NamedTuple):
    """LQI by Bryson's rule of a linear model whose state is measured or estimated.

    Parameters
    ----------
    model : LinearModel
        Without states that act on no output, but those of an estimation.
    measurements : tuple of str
        Of every state; of an estimation what it reads.
    """

    name: str
    model: LinearModel
    deviations: Deviations
    measurements: tuple[str, ...]
    anti_windup: AntiWindup
    estimation: Estimation | None = None

    def slower(self, factor: float) -> FoundLqi:
        """Return the one with moves that are smaller and a horizon that is longer."""
        asked, model, shown = self.deviations.slower(factor), self.model, self.measurements
        gains = lqi_gains(model, asked.weights(model), self._process.sampling_period, asked.horizon)
        feedback, integral = gains.feedback, gains.integral
        times = [asked.horizon] * len(model.inputs)
        if self.estimation is None:
            feedback = of_measurements(model, shown, feedback)
            times = tracking_times(model, shown, feedback, integral, asked.horizon)
        parts = shown, feedback, integral, times, self.anti_windup, self.estimation
        return FoundLqi(lqi_controller(self.name, model, *parts), gains, asked)

    def robust(self, model: LinearModel) -> SlowedDown[FoundLqi]:
        """Return the fastest one with a sensitivity peak of at most 2 on a model of the process.

        Raises
        ------
        NotApplicable
            Slowing down does not bring the peak to 2, or the gains cannot be computed.
        """
        return slow_down(self.slower, lambda each: sensitivity_peak(each.controller, model))

    def described(
        self,
        found: SlowedDown[FoundLqi],
        controller: Controller,
        how: str = "",
        where: str = "",
        *,
        of_filter: bool = False,
    ) -> Controller:
        """Return a controller with these gains, with how it was found in words."""
        _, gains, asked = found.design
        slowest = self._slowest(gains.eigenvalues)
        time = f"slowest closed-loop time constant {slowest}"
        if of_filter and self.estimation is not None:
            slower = self._slowest(self.estimation.error_poles)
            time = f"slowest time constants {slowest} of the regulator and {slower} of the filter"
        return controller.described(
            f"LQI with Bryson's weights, {asked.in_words(self._process)}, an error lasting at most "
            f"{time_text(asked.horizon)}{how}; {where}{time}, sensitivity peak {found.peak:.2f}.",
            note_on_slowing(found, "the regulator"),
            found.factor,
        )

    def _slowest(self, eigenvalues: np.ndarray) -> str:
        return time_text(slowest_time_constant(eigenvalues, self._process.sampling_period))

    @property
    def _process(self) -> Process:
        return operating_point_of(self.model).process


def check_lqi(model: LinearModel, delays: object = None, states: str = "its law has") -> Process:
    """Return the process of a model, refused where an LQI law cannot control it.

    Parameters
    ----------
    delays : object
        Dead times of which the law would have to know, if any.
    states : str
        What has none for what is on its way.

    Raises
    ------
    NotApplicable
        There is dead time, a signal has an open range, or there are more inputs than outputs:
        integrals that differ without effect never settle.

    Examples
    --------
    >>> import clepsydra as cl
    >>> check_lqi(cl.load("quadruple-tank").linear).sampling_period
    1.0
    """
    process = operating_point_of(model).process
    if delays:
        raise NotApplicable(
            f"the process has dead time, and {states} no states for what is on its way; LQI with a "
            "Kalman filter has them"
        )
    if len(model.inputs) > len(model.outputs):
        raise NotApplicable(
            f"{len(model.inputs)} inputs move {len(model.outputs)} controlled outputs, and it "
            "integrates one error for each input"
        )
    check_ranges(process, model.outputs, model.inputs)
    return process


def tracking_times(
    model: LinearModel,
    measurements: tuple[str, ...],
    feedback: np.ndarray,
    integral: np.ndarray,
    horizon: float,
) -> list[float]:
    """Return proportional over integral gain of the controlled outputs, a PI's Ti [s].

    Parameters
    ----------
    feedback : ndarray [m, measurements]
        F of the measurements.
    integral : ndarray [m, q]
        G.
    horizon : float
        For an input that the integrators do not move [s].

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> tracking_times(tank, ("level",), 6.0 * one, 2.0 * one, 9.0)
    [3.0]
    """
    columns = [measurements.index(name) for name in model.outputs]
    times = []
    for row, summed in zip(feedback, integral, strict=True):
        proportional, size = np.linalg.norm(row[columns]), np.linalg.norm(summed)
        # An input that the integrators do not move cannot wind up: any time will do.
        both = size > 0.0 and proportional > 0.0
        times.append(float(proportional / size) if both else horizon)
    return times
