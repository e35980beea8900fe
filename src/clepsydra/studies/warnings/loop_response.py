"""The frequency response of an exact sampled loop, broken at the sensors and at the actuators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import LinearStepLaw
from clepsydra.designs.sampled.sampled_loop import SampledLoop, SampledLoops
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.response import evaluate_transfer
from clepsydra.loop.inner_setpoints import inner_loops
from clepsydra.studies.warnings.channel import Channel

_PER_DECADE = 60
_SLOWEST = 1e-9
#: A range of frequencies below the slowest mode of the loop, and below that nothing happens.
_BELOW = 30.0
#: Around a resonance, in units of its half-width.
_AROUND = np.array([-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0])
#: Registers of dead times are sparse: from this many states on it pays to use that.
_MANY_STATES = 60


@dataclass(frozen=True, eq=False)
class LoopResponse:
    """The sensitivity of a sampled loop at each frequency, signals as shares of their ranges.

    Parameters
    ----------
    period : float
        Sampling period T [s].
    frequencies : ndarray [l]
        Rising, up to half the sampling frequency π/T [rad/s].
    outputs, inputs : tuple of str
        The controlled measurements and the manipulated variables.
    at_output : ndarray [l, q, q], complex
        S from something added to the controlled measurements to what the law reads of them.
    at_input : ndarray [l, m, m], complex
        S from something added to the law's outputs to what the process gets.
    loop : SampledLoop
        The loop itself, with every state of process and law.
    law : LinearStepLaw
        The law alone.
    at_inner : mapping
        Measurement of each inner loop of a cascade to S there, from something added to the
        measurement to what the law reads of it, ndarray [l], complex; the other loops closed.
    """

    period: float
    frequencies: np.ndarray
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    at_output: np.ndarray
    at_input: np.ndarray
    loop: SampledLoop
    law: LinearStepLaw
    at_inner: Mapping[str, np.ndarray] = field(default_factory=dict)

    @cached_property
    def channels(self) -> dict[str, Channel]:
        """Each measurement of a loop and manipulated variable broken alone, the others closed.

        These are the controlled measurements, those of inner loops, the manipulated variables.
        With one channel broken S is 1/(1 + L), so L follows from the diagonal of S.
        """
        sensitivities = {
            **{name: self.at_output[:, k, k] for k, name in enumerate(self.outputs)},
            **self.at_inner,
            **{name: self.at_input[:, k, k] for k, name in enumerate(self.inputs)},
        }
        return {
            name: Channel(self.frequencies, 1.0 / sensitivity - 1.0)
            for name, sensitivity in sensitivities.items()
        }

    @property
    def inner_peak(self) -> tuple[str, float] | None:
        """The inner loop with the largest max|S|, and that; None without inner loops."""
        peaks = {name: float(np.max(np.abs(values))) for name, values in self.at_inner.items()}
        return max(peaks.items(), key=lambda entry: entry[1], default=None)


def loop_response(controller: Controller, model: LinearModel) -> LoopResponse:
    """Return the response of the process, held over each sample, under the derivatives of a law.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point, with the measurements that the controller reads.

    Raises
    ------
    InputError, NotApplicable
        As `designs.sampled.sampled_loop`.

    References
    ----------
    K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 1997.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> response = loop_response(controller, plant.linear)
    >>> round(float(np.degrees(response.channels["level_1"].phase_margin[0])), 1)
    79.2
    """
    loops = SampledLoops(controller, model)
    law = loops.law(controller.values)
    loop = loops.around(law)
    process, manipulated = operating_point_of(model).process, controller.manipulated
    period = process.sampling_period
    frequencies = _frequencies(loop, period)
    z = np.exp(1j * frequencies * period)
    plant = _transfer(loops.held, loops.moved, loops.measured, z)
    feedback = evaluate_transfer(law.A, law.B_measurement, law.C, law.D_measurement, z)
    # A setpoint whose measurement the law does not read closes no loop.
    read = [name for name in controller.setpoints if name in controller.measurements]
    outputs = tuple(dict.fromkeys(read))
    places = [controller.measurements.index(name) for name in outputs]
    measured_inside = dict.fromkeys(name for _, name in inner_loops(controller))
    inner = tuple(name for name in measured_inside if name not in outputs)
    broken = (*outputs, *inner)
    # A measurement that the law reads twice is disturbed in both places at once.
    enters = np.array([[float(y == name) for name in broken] for y in controller.measurements])
    at_sensors = np.linalg.solve(np.eye(len(enters)) - plant @ feedback, enters)
    at_output = at_sensors[:, places, : len(outputs)]
    at_input = np.linalg.inv(np.eye(len(manipulated)) - feedback @ plant)
    spans = [np.array([_size(process.signal(n).span) for n in g]) for g in (outputs, manipulated)]
    return LoopResponse(
        period=period,
        frequencies=frequencies,
        outputs=outputs,
        inputs=manipulated,
        at_output=at_output * spans[0] / spans[0][:, None],
        at_input=at_input * spans[1] / spans[1][:, None],
        loop=loop,
        law=law,
        at_inner={
            name: at_sensors[:, controller.measurements.index(name), len(outputs) + place]
            for place, name in enumerate(inner)
        },
    )


def _frequencies(loop: SampledLoop, period: float) -> np.ndarray:
    """Return frequencies that show all that a loop does, up to half the sampling frequency."""
    eigenvalues = np.linalg.eigvals(loop.A)
    rates = np.log(eigenvalues[np.abs(eigenvalues) > 1e-6].astype(complex)) / period
    fastest = np.pi / period
    sizes = np.abs(rates)
    slowest = float(np.min(sizes[sizes > _SLOWEST * fastest], initial=fastest)) / _BELOW
    count = int(np.ceil(_PER_DECADE * np.log10(fastest / slowest))) + 1
    ringing = rates[(rates.imag > 0.0) & (np.abs(rates.real) < 0.3 * rates.imag)]
    around = (ringing.imag[:, None] + np.abs(ringing.real)[:, None] * _AROUND).ravel()
    inside = around[(around > slowest) & (around < fastest)]
    return np.unique(np.concatenate([np.geomspace(slowest, fastest, count), inside]))


def _transfer(A: np.ndarray, B: np.ndarray, C: np.ndarray, points: np.ndarray) -> np.ndarray:
    if len(A) < _MANY_STATES:
        return evaluate_transfer(A, B, C, np.zeros((len(C), B.shape[1])), points)
    from scipy.sparse import csc_matrix, identity
    from scipy.sparse.linalg import splu

    sparse, one = csc_matrix(A.astype(complex)), identity(len(A), dtype=complex, format="csc")
    driven = B.astype(complex)
    return np.array([C @ splu(z * one - sparse).solve(driven) for z in points])


def _size(span: float) -> float:
    return span if np.isfinite(span) else 1.0
