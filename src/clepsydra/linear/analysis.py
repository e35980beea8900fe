"""Everything that the linear model says about a process, collected for the reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.analysis_words import (
    words_on_gain,
    words_on_interaction,
    words_on_poles,
    words_on_zeros,
)
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.niederlinski import niederlinski_index
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.poles import poles, time_constants
from clepsydra.linear.relative_gain_array import relative_gains, suggest_pairing
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import minimum_phase, zeros
from clepsydra.process.process import Process


@dataclass(frozen=True, eq=False)
class Analysis:
    """A process near its operating point.

    Parameters
    ----------
    operating_point : OperatingPoint
    model : LinearModel
        From all inputs to the controlled outputs.
    poles, zeros : ndarray, complex
        [rad/s], rightmost first.
    minimum_phase : bool
    time_constants : ndarray [n]
        [s], in the order of the poles; infinite for a pole on the imaginary axis.
    static_gain : ndarray [q, m]
        [output unit / input unit]; infinite where the model integrates.
    relative_gain_array : ndarray [q, m] or None
        None where the outputs cannot be set independently.
    pairing : tuple of (output, input)
        The suggested one; empty where there is no relative gain array.
    niederlinski_index : float or None
        Of that pairing; None where it is not defined.
    words : tuple of str
        What follows for control, a sentence each.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank-nonminimum-phase"))
    >>> analysis.minimum_phase, analysis.pairing
    (False, (('level_1', 'pump_2'), ('level_2', 'pump_1')))
    """

    operating_point: OperatingPoint
    model: LinearModel
    poles: np.ndarray
    zeros: np.ndarray
    minimum_phase: bool
    time_constants: np.ndarray
    static_gain: np.ndarray
    relative_gain_array: np.ndarray | None
    pairing: tuple[tuple[str, str], ...]
    niederlinski_index: float | None
    words: tuple[str, ...]

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
        relative = self.relative_gain_array
        return {
            "process": process.name,
            "operating_point": self.operating_point.as_dict(),
            "residual": self.operating_point.residual,
            "states": list(model.states),
            "inputs": list(model.inputs),
            "disturbances": list(model.disturbances),
            "outputs": list(model.outputs),
            "A": model.A.tolist(),
            "B": model.B.tolist(),
            "C": model.C.tolist(),
            "D": model.D.tolist(),
            "E": model.E.tolist(),
            "poles": [_complex(root) for root in self.poles],
            "zeros": [_complex(root) for root in self.zeros],
            "minimum_phase": self.minimum_phase,
            "time_constants": [_finite_or_none(value) for value in self.time_constants],
            "static_gain": [[_finite_or_text(value) for value in row] for row in self.static_gain],
            "rga": None if relative is None else relative.tolist(),
            "pairing": [list(pair) for pair in self.pairing],
            "niederlinski_index": _finite_or_none(self.niederlinski_index),
            "units": units,
            "words": list(self.words),
            "warnings": list(self.operating_point.warnings),
        }


def analyse(
    process: Process,
    inputs: Mapping[str, float] | None = None,
    outputs: Mapping[str, float] | None = None,
    disturbances: Mapping[str, float] | None = None,
) -> Analysis:
    """Find the operating point of a process and say what its linear model means for control.

    Parameters
    ----------
    process : Process
    inputs, outputs, disturbances : mapping, optional
        What fixes the operating point, as in `find_equilibrium`.

    Returns
    -------
    Analysis

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
    point = find_equilibrium(process, inputs, outputs, disturbances)
    model = linearise(point).select(outputs=process.controlled)
    gain = static_gain(model)
    relative: np.ndarray | None
    try:
        relative = relative_gains(model)
    except InputError:  # singular: the words say which outputs hang together
        relative = None
    pairing = (
        () if relative is None else tuple(suggest_pairing(relative, model.outputs, model.inputs))
    )
    index = None
    if pairing and np.all(np.isfinite(gain)):
        index = niederlinski_index(gain, pairing, model.outputs, model.inputs)
    rates, rises = poles(model), zeros(model)
    constants, well_behaved = time_constants(model), minimum_phase(model)
    return Analysis(
        operating_point=point,
        model=model,
        poles=rates,
        zeros=rises,
        minimum_phase=well_behaved,
        time_constants=constants,
        static_gain=gain,
        relative_gain_array=relative,
        pairing=pairing,
        niederlinski_index=index,
        words=(
            *words_on_poles(model, rates, constants),
            *words_on_zeros(model, rises, well_behaved),
            *words_on_gain(model, gain),
            *words_on_interaction(model, relative, pairing, index),
        ),
    )


def _complex(root: complex) -> dict[str, float]:
    return {"re": float(root.real), "im": float(root.imag)}


def _finite_or_none(value: float | None) -> float | None:
    return float(value) if value is not None and np.isfinite(value) else None


def _finite_or_text(value: float) -> float | str:
    return float(value) if np.isfinite(value) else str(float(value))
