"""The linear model of a sampled loop, exact at the sampling instants."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import LinearStepLaw, StepLawDerivatives
from clepsydra.designs.sampled.sampled_process import sampled_process
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.designs.sampled.sampling_period import check_sampling_period
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: Of a mode: what is gone after two samples, what has no direction of its own, and the share of
#: the largest answer from which on it is seen.
_DEAD, _DEFECTIVE, _SEEN = 0.1, 1e-6, 0.01


class SampledLoop(SampledSystem):
    """x(k+1) = A x(k) + B d(k), e(k) = C x(k) + D d(k): the output sensitivity of a loop.

    d is added to the controlled measurements as they reach the step law, and e is what the
    law then sees of them, both as shares of the measurements' ranges. So D is the identity.

    Examples
    --------
    An integrator under proportional control that takes half of the error in each sample,
    S = (z − 1)/(z − 0.5), has its peak at half the sampling frequency, z = −1:

    >>> one = np.eye(1)
    >>> loop = SampledLoop(0.5 * one, -0.5 * one, one, one)
    >>> loop.is_stable, round(loop.maximum_sensitivity, 6)
    (True, 1.333333)
    """

    @cached_property
    def maximum_sensitivity(self) -> float:
        """Largest singular value of S(e^jωT) over frequency [1]; infinite if unstable."""
        return self.largest_gain

    @cached_property
    def damping(self) -> float:
        """Smallest damping ratio ζ of what swings in the loop [1]; below 0 if unstable.

        Of each mode z = e^(sT), ζ = −Re s/|s|. A mode that makes less than a hundredth of the
        answer to a step of d does not count, nor what dies within a sample or two: the registers
        of a dead time. 1 where nothing swings.

        Examples
        --------
        Both modes of 1/(s² + 2 ζ s + 1) with ζ = 0.5, sampled every 0.1 s:

        >>> z = np.exp(0.1 * (-0.5 + 1j * np.sqrt(0.75)))
        >>> A = np.array([[z.real, z.imag], [-z.imag, z.real]])
        >>> loop = SampledLoop(A, np.ones((2, 1)), np.ones((1, 2)), np.eye(1))
        >>> round(loop.damping, 9)
        0.5
        """
        rates = self._rates
        if rates is None:
            return -1.0
        return float(np.min(-rates.real / np.abs(rates), initial=1.0))

    @cached_property
    def decay(self) -> float:
        """Samples in which the slowest of these modes comes down to a hundredth [1].

        Infinite if unstable.
        """
        rates = self._rates
        if rates is None:
            return math.inf
        return math.log(100.0) * float(np.max(-1.0 / rates.real, initial=0.0))

    @cached_property
    def _rates(self) -> np.ndarray | None:
        """The logarithms of the modes that are seen; None if unstable."""
        from scipy.linalg import eig

        modes, left, right = eig(self.A, left=True)
        if np.any(np.abs(modes) >= 1.0):
            return None
        entering = np.linalg.norm(left.conj().T @ self.B, axis=1)
        leaving = np.linalg.norm(self.C @ right, axis=0)
        own = np.abs(np.sum(left.conj() * right, axis=0))
        alive = (np.abs(modes) > _DEAD) & (own > _DEFECTIVE)
        share = np.where(alive, entering * leaving / np.where(alive, own, 1.0), 0.0)
        share /= np.abs(modes - 1.0)
        seen = alive & (share > _SEEN * np.max(share, initial=0.0))
        return np.asarray(np.log(modes[seen].astype(complex)))


def sampled_loop(controller: Controller, model: LinearModel) -> SampledLoop:
    """Join the process, held over each sample, and the derivatives of the step law.

    S is that of the measurements which the controller has setpoints for.

    Raises
    ------
    InputError
        The model has no operating point, lacks a signal of the controller, has a direct way
        from an input to an output, or is sampled too slowly (`designs.sampled.sampling_period`).
    NotApplicable
        The model has dead time that a sampled model cannot hold, see
        `designs.sampled.sampled_process`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> controller = cl.design.simc(plant)
    >>> round(sampled_loop(controller, plant.linear).maximum_sensitivity, 3)
    2.0
    """
    return SampledLoops(controller, model).at(controller.values)


def inputs_at_rest(controller: Controller, model: LinearModel) -> dict[str, float]:
    """Return what the inputs of a controller are at the operating point of a model.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> inputs = inputs_at_rest(cl.design.simc(plant), plant.linear)
    >>> inputs["time_step"], inputs["level_1.sp"] == inputs["level_1.pv"]
    (1.0, True)
    """
    point = operating_point_of(model)
    at = point.as_dict()
    wires = {name: wire.removesuffix(".setpoint") for name, wire in controller.input_wires.items()}
    given = {name: at[wire] for name, wire in wires.items() if wire in at}
    return given | {**controller.free_inputs, "time_step": point.process.sampling_period}


class SampledLoops:
    """The sampled loops of one controller, for any values of its parameters.

    What does not depend on the values is computed once, so that a design can try many.

    Parameters
    ----------
    controller : Controller
        Its law, wiring and initial state count, not its values.
    model : LinearModel
        As for `sampled_loop`.

    Attributes
    ----------
    held, moved, measured : ndarray [n, n], [n, m], [p, n]
        x⁺ = A x + B u, y = C x of the process, held over each sample, from what the controller
        moves to what it reads.
    enters, controlled, sizes : ndarray [p, q], [q, n], [q]
        Where the law reads each controlled measurement, what these are of x, and their ranges.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> loops = SampledLoops(controller, plant.linear)
    >>> loops.at(controller.values | {"level_1.proportional_gain": -3.0}).is_stable
    False
    """

    def __init__(self, controller: Controller, model: LinearModel) -> None:
        period = check_sampling_period(model)
        point = operating_point_of(model)
        process = point.process
        controlled = tuple(dict.fromkeys(controller.setpoints))
        read = tuple(dict.fromkeys((*controller.measurements, *controlled)))
        seen = model.select(read, controller.manipulated)
        if np.any(seen.D != 0.0):
            raise InputError(
                "linear model, D",
                seen.D.tolist(),
                "zeros: a sampled law reads its measurements before it moves the inputs",
                "let the input act through a state",
            )
        self._derivatives = StepLawDerivatives(controller.law)
        self._state = controller.initial_state
        self._inputs = inputs_at_rest(controller, model)
        self.held, self.moved, shown = sampled_process(seen, period)
        self.measured = shown[[read.index(name) for name in controller.measurements]]
        self.enters = np.array(
            [[float(y == name) for name in controlled] for y in controller.measurements]
        )
        self.controlled = shown[[read.index(name) for name in controlled]]
        spans = np.array([process.signal(name).span for name in controlled])
        self.sizes = np.where(np.isfinite(spans), spans, 1.0)

    def at(self, values: Mapping[str, float]) -> SampledLoop:
        """Return the loop with these parameter values."""
        return self.around(self.law(values))

    def each(self, values: Mapping[str, ArrayLike]) -> list[tuple[np.ndarray, SampledLoop]]:
        """Return the loops with k parameter values, those of one size as a stack.

        Parameters
        ----------
        values : mapping
            Parameter to its value for all, or to its values [k].

        Returns
        -------
        list of (ndarray, SampledLoop)
            Which of the k are in a stack, and the stack.

        Examples
        --------
        >>> import clepsydra as cl
        >>> plant = cl.load("quadruple-tank")
        >>> controller = cl.design.simc(plant)
        >>> loops, gains = SampledLoops(controller, plant.linear), np.array([3.0, -3.0])
        >>> values = controller.values | {"level_1.proportional_gain": gains}
        >>> ((places, stack),) = loops.each(values)
        >>> places, stack.are_stable
        (array([0, 1]), array([ True, False]))
        """
        stacks = self._derivatives.each(values, self._state, self._inputs)
        return [(places, self.around(law)) for places, law in stacks]

    def law(self, values: Mapping[str, float]) -> LinearStepLaw:
        """Return the derivatives of the law at rest with these parameter values."""
        return self._derivatives.at(values, self._state, self._inputs)

    def around(self, law: LinearStepLaw) -> SampledLoop:
        """Return the loop with these derivatives of the law; of a stack of them a stack."""
        entering = [self.moved @ law.D_measurement, law.B_measurement]
        B = np.concatenate(entering, axis=-2) @ self.enters
        C, sizes, stack = self._shown(law), self.sizes, law.A.shape[:-2]
        shown, direct = (
            np.broadcast_to(matrix, (*stack, *matrix.shape))
            for matrix in (C / sizes[:, None], np.eye(len(sizes)))
        )
        return SampledLoop(self._closed(law), B * sizes, shown, direct)

    def from_setpoints(
        self, values: Mapping[str, float]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B and C of x⁺ = A x + B r, y = C x from setpoints to what they belong to."""
        law = self.law(values)
        B = np.vstack([self.moved @ law.D_setpoint, law.B_setpoint])
        return self._closed(law), B, self._shown(law)

    def _closed(self, law: LinearStepLaw) -> np.ndarray:
        C, moved, n = self.measured, self.moved, len(self.held)
        size = n + law.A.shape[-1]
        closed = np.empty((*law.A.shape[:-2], size, size))
        closed[..., :n, :n] = self.held + moved @ law.D_measurement @ C
        closed[..., :n, n:] = moved @ law.C
        closed[..., n:, :n], closed[..., n:, n:] = law.B_measurement @ C, law.A
        return closed

    def _shown(self, law: LinearStepLaw) -> np.ndarray:
        return np.hstack([self.controlled, np.zeros((len(self.sizes), law.A.shape[-1]))])
