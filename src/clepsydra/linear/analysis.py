"""Everything that the linear model says about a process, collected for the reader."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.json_values import json_values
from clepsydra.linear.analysis_words import (
    words_on_dead_time,
    words_on_gain,
    words_on_interaction,
    words_on_poles,
    words_on_speed,
    words_on_zero_directions,
    words_on_zeros,
)
from clepsydra.linear.controllability import Reach, reach_of, words_about_reach
from clepsydra.linear.dead_time import dead_times
from clepsydra.linear.directionality import Directionality, directionality, few_frequencies
from clepsydra.linear.directions import ZeroDirection, blocking_zeros
from clepsydra.linear.equilibrium import find_equilibria
from clepsydra.linear.equilibrium_request import Given
from clepsydra.linear.late_outputs import words_on_late_readings
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.pairing import PairedGains, compared, paired_gains
from clepsydra.linear.relative_gain_array import niederlinski_index, relative_gains
from clepsydra.linear.roots import Roots, roots_of
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import minimum_phase
from clepsydra.process.process import Process

_OF_MODEL = ("states", "inputs", "disturbances", "outputs", *"ABCDE")
_OF_ROOTS = ("poles", "zeros", "minimum_phase", "time_constants")


@dataclass(frozen=True, eq=False)
class Analysis:
    """A process near its operating point.

    Parameters
    ----------
    model : LinearModel
        From all inputs to the controlled outputs.
    poles, zeros : ndarray, complex
        [rad/s], rightmost first. With dead time see `roots_note`.
    minimum_phase : bool
        With neither a zero in the right half-plane nor dead time between inputs and outputs.
    time_constants : ndarray [n]
        [s], in the order of the poles; infinite for a pole on the imaginary axis.
    static_gain : ndarray [q, m]
        [output unit / input unit]; infinite where the model integrates.
    relative_gain_array : ndarray [q, m] or None
        None where the outputs cannot be set independently. Of a process that is not square it
        is that of the pseudo-inverse in shares of the ranges.
    paired_gains : tuple of PairedGains
        The suggested pairs, with their relative gains; empty where there is no relative gain
        array.
    niederlinski_index : float or None
        Of that pairing; None where it is not defined.
    words : tuple of str
        What follows for control, a sentence each.
    dead_times : ndarray [q, m]
        [s], of each pair by itself; zero where the input does not move the output, not a number
        where ways of different dead time lead to it.
    roots_note : str
        In which sense poles and zeros are those of a process with dead time; empty without.
    """

    operating_point: OperatingPoint
    model: LinearModel
    poles: np.ndarray
    zeros: np.ndarray
    minimum_phase: bool
    time_constants: np.ndarray
    static_gain: np.ndarray
    relative_gain_array: np.ndarray | None
    paired_gains: tuple[PairedGains, ...]
    niederlinski_index: float | None
    words: tuple[str, ...]
    dead_times: np.ndarray
    roots_note: str = ""

    @property
    def pairing(self) -> tuple[tuple[str, str], ...]:
        """The suggested pairs of output and input."""
        return tuple((pair.output, pair.input) for pair in self.paired_gains)

    @cached_property
    def directionality(self) -> Directionality:
        """Singular values, condition numbers and relative gains at a few frequencies."""
        return directionality(self.model, few_frequencies(self.model, self.poles))

    @cached_property
    def reach(self) -> Reach | None:
        """How nearly controllability and observability fail; None where a range is missing."""
        return reach_of(self.model)

    @cached_property
    def right_half_plane_zeros(self) -> list[ZeroDirection]:
        """The zeros that limit control, with their directions in ranges where these are known."""
        return blocking_zeros(self.model)

    def as_dict(self) -> dict[str, Any]:
        """Return the analysis as values for JSON, in SI.

        A complex number is {"re": …, "im": …}. JSON has no infinity: an infinite time constant
        or Niederlinski index is null, and an infinite static gain the text "inf" or "-inf".
        """
        model, process = self.model, self.operating_point.process
        signals = (process.state, process.inputs, process.disturbances, process.measurements)
        units = {signal.name: signal.unit for group in signals for signal in group}
        units |= {"poles": "rad/s", "zeros": "rad/s", "time_constants": "s", "rga": "1"}
        units["static_gain"] = "output unit / input unit"
        units |= {"dead_times": "s", "frequencies": "rad/s", "singular_values": "1"}
        units |= {"condition_numbers": "1", "relative_gains": "1", "share": "1", "margin": "1/s"}
        units |= {"distance_to_uncontrollability": "1/s", "distance_to_unobservability": "1/s"}
        units |= {"hankel_singular_values": "1"}
        values = {
            "process": process.name,
            "operating_point": self.operating_point.as_dict(),
            "residual": self.operating_point.residual,
            **{name: getattr(model, name) for name in _OF_MODEL},
            **{name: getattr(self, name) for name in _OF_ROOTS},
            "static_gain": [
                [gain if np.isfinite(gain) else str(float(gain)) for gain in row]
                for row in self.static_gain
            ],
            "rga": self.relative_gain_array,
            "pairing": self.pairing,
            "paired_gains": [pair._asdict() for pair in self.paired_gains],
            "niederlinski_index": self.niederlinski_index,
            "dead_times": self.dead_times,
            "roots_note": self.roots_note,
            "directionality": self.directionality.as_dict(),
            "reach": None if self.reach is None else self.reach.as_dict(),
            "right_half_plane_zeros": [
                {"zero": zero, "inputs": inputs, "outputs": outputs}
                for zero, inputs, outputs in self.right_half_plane_zeros
            ],
            "units": units,
            "words": self.words,
            "warnings": self.operating_point.warnings,
        }
        found: dict[str, Any] = json_values(values)
        return found


def analyse(
    process: Process, inputs: Given = None, outputs: Given = None, disturbances: Given = None
) -> Analysis:
    """Find the operating point of a process and say what its linear model means for control.

    Parameters
    ----------
    inputs, outputs, disturbances : mapping, optional
        What fixes the operating point, as in `find_equilibrium`.

    Raises
    ------
    NoEquilibrium
        There is no operating point as asked.
    InputError
        The request cannot be used, or a tank is empty at the operating point.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> analysis.relative_gain_array.round(6).tolist(), analysis.pairing[0]
    ([[1.4, -0.4], [-0.4, 1.4]], ('level_1', 'pump_1'))
    """
    point = find_equilibria(process, inputs, outputs, disturbances)[0]
    model = linearise(point).select(outputs=process.controlled)
    gain = static_gain(model)
    relative: np.ndarray | None
    try:
        relative = relative_gains(compared(model))
    except InputError:  # singular: the words say which outputs hang together
        relative = None
    pairs = () if relative is None else tuple(paired_gains(model))
    index = None
    if pairs and np.all(np.isfinite(gain)):
        pairing = [(pair.output, pair.input) for pair in pairs]
        index = niederlinski_index(gain, pairing, model.outputs, model.inputs)
    roots, late = roots_of(model), dead_times(model)
    return Analysis(
        operating_point=point,
        model=model,
        poles=roots.poles,
        zeros=roots.zeros,
        minimum_phase=roots.minimum_phase,
        time_constants=roots.time_constants,
        static_gain=gain,
        relative_gain_array=relative,
        paired_gains=pairs,
        niederlinski_index=index,
        words=(
            *words_on_poles(roots.zeros_of, roots.poles, roots.time_constants),
            *words_on_speed(model, roots.poles, process.sampling_period),
            *words_on_interaction(model, relative, pairs, index),
            *words_on_late_readings(process),
            *words_on_dead_time(model, late, roots.note),
            *words_on_zeros(roots.zeros_of, roots.zeros, _rationally_minimum(roots)),
            *words_on_zero_directions(model, blocking_zeros(model)),
            *words_on_gain(model, gain),
            *words_about_reach(model),
        ),
        dead_times=late,
        roots_note=roots.note,
    )


def _rationally_minimum(roots: Roots) -> bool:
    """Return whether the process is minimum phase but for its dead time."""
    return roots.minimum_phase or (bool(roots.note) and minimum_phase(roots.zeros_of))
