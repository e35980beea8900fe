"""What the designs of multiloop PI controllers share: pairing checked, controller made."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.proportional_integral import FAMILY, multiloop_pi_law
from clepsydra.design.applicability import NotApplicable, check_designed
from clepsydra.design.control_authority import check_ranges, largest_proportional_gain
from clepsydra.design.detuning import SENSITIVITY_LIMIT, Detuned
from clepsydra.design.pi_settings import PiSettings
from clepsydra.design.sampled_loop import SampledLoops
from clepsydra.design.sampled_process import NotSampled
from clepsydra.design.transfer_element import TransferElement, transfer_element
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

Pairing = Sequence[tuple[str, str]]


class PairedLoop(NamedTuple):
    """One pair: measurement, input, the element between them, and the input at rest.

    Examples
    --------
    >>> element = TransferElement(1.0, (-1.0,), (), 0)
    >>> loop = PairedLoop(Signal("level", "V", low=0.0, high=10.0),
    ...                   Signal("pump", "V", low=0.0, high=10.0), element, 3.0)
    >>> loop.pair, loop.largest_gain
    ('level by pump', 3.0)
    """

    output: Signal
    input: Signal
    element: TransferElement
    resting_input: float

    @property
    def pair(self) -> str:
        """The pair as the reader sees it."""
        return f"{self.output.name} by {self.input.name}"

    @property
    def largest_gain(self) -> float:
        """The largest proportional gain that the room of the input allows."""
        return largest_proportional_gain(self.output, self.input, self.resting_input)


class MultiloopPi:
    """The PI controllers of one pairing on one model, for any settings.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.
    pairing : sequence of (output, input)
    anti_windup : {"back_calculation", "conditional_integration"}
    method : str
        Of the design, for names and messages.

    Raises
    ------
    InputError
        The model has no operating point, the pairing is empty, names an unknown signal or one
        signal twice, or the anti-windup is unknown.
    NotApplicable
        A signal has no range, or one beyond what a controller takes, an input does not move
        its output, or dead times have no place in a transfer function or a sampled loop.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> loops = MultiloopPi(analysis.model, analysis.pairing, "conditional_integration", "by hand")
    >>> [(loop.pair, loop.resting_input) for loop in loops.loops]
    [('level_1 by pump_1', 3.0), ('level_2 by pump_2', 3.0)]
    """

    def __init__(
        self, model: LinearModel, pairing: Pairing, anti_windup: AntiWindup, method: str
    ) -> None:
        self.method = method
        self.point = operating_point_of(model)
        self.process = self.point.process
        outputs, inputs = _checked(pairing, model)
        check_ranges(self.process, outputs, inputs, method)
        at = self.point.as_dict()
        self.loops: list[PairedLoop] = []
        for output, input_name in zip(outputs, inputs, strict=True):
            found = transfer_element(model, output, input_name, method=method)
            if found is None:
                raise NotApplicable(method, f"{input_name} does not move {output}")
            signals = self.process.signal(output), self.process.signal(input_name)
            self.loops.append(PairedLoop(*signals, found, at[input_name]))
        self._without_settings = self._blank(outputs, inputs, anti_windup)
        try:
            self._sampled = SampledLoops(self._without_settings, model)
        except NotSampled as refusal:
            raise NotApplicable(
                method, f"its sampled loops need {refusal.expected}; {refusal.remedy}"
            ) from None

    def peak(self, settings: Sequence[PiSettings]) -> float:
        """Return the sensitivity peak of all loops closed; infinite if they are unstable."""
        return self._sampled.at(self._values(settings)).maximum_sensitivity

    def controller(self, found: Detuned, design: str, notes: Sequence[str]) -> Controller:
        """Return the controller with these settings, at rest at the operating point.

        The setpoint weight is 1, the tracking time the integral time, and the limits are the
        ranges of the inputs.

        Parameters
        ----------
        found : Detuned
        design : str
            How the settings were found; their values and the peak are added.
        notes : sequence of str

        Raises
        ------
        NotApplicable
            A setting is outside of what a controller takes.
        """
        values = self._values(found.settings)
        check_designed(self._without_settings.law, values, self.method)
        return dataclasses.replace(
            self._without_settings,
            design=(
                f"{design}: {self._in_words(found.settings)}; sensitivity peak of all loops "
                f"together {found.peak:.2f}."
            ),
            values=values,
            notes=tuple(notes),
        )

    def _blank(
        self, outputs: tuple[str, ...], inputs: tuple[str, ...], anti_windup: AntiWindup
    ) -> Controller:
        law = multiloop_pi_law(
            len(self.loops),
            anti_windup,
            measured=[loop.output for loop in self.loops],
            manipulated=[loop.input for loop in self.loops],
        )
        values = {parameter.name: parameter.initial for parameter in law.parameters}
        check_designed(law, values, self.method)
        # At rest r = y and b = 1, so the integral is the whole output.
        initial_state = {
            f"{name}_{i}": loop.resting_input
            for i, loop in enumerate(self.loops, start=1)
            for name in ("integral", "last_output")
        }
        return Controller(
            name=f"PI, {self.method}",
            family=FAMILY,
            design="",
            law=law,
            values=values,
            initial_state=initial_state,
            measurements=outputs,
            setpoints=outputs,
            manipulated=inputs,
        )

    def _values(self, settings: Sequence[PiSettings]) -> dict[str, float]:
        values = dict(self._without_settings.values)
        for i, (loop, setting) in enumerate(zip(self.loops, settings, strict=True), start=1):
            values |= {
                f"proportional_gain_{i}": setting.gain,
                f"integral_time_{i}": setting.integral_time,
                f"setpoint_weight_{i}": 1.0,
                f"low_limit_{i}": loop.input.low,
                f"high_limit_{i}": loop.input.high,
            }
            if f"tracking_time_{i}" in values:
                values[f"tracking_time_{i}"] = setting.integral_time
        return values

    def _in_words(self, settings: Sequence[PiSettings]) -> str:
        return "; ".join(
            f"{loop.pair}: K = {setting.gain:.3g} {loop.input.unit}/{loop.output.unit}, "
            f"Ti = {setting.integral_time:.3g} s"
            for loop, setting in zip(self.loops, settings, strict=True)
        )


def note_on_peak(found: Detuned, remedy: str) -> list[str]:
    """Return a note where settings that the user chose have thin margins.

    Examples
    --------
    >>> note_on_peak(Detuned((PiSettings(9.0, 30.0),), 1.0, 2.5), "choose a lower crossover")
    ['The sensitivity peak is 2.50, above 2: choose a lower crossover.']
    """
    if found.peak <= SENSITIVITY_LIMIT:
        return []
    return [f"The sensitivity peak is {found.peak:.2f}, above {SENSITIVITY_LIMIT:g}: {remedy}."]


def _checked(pairing: Pairing, model: LinearModel) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the outputs and the inputs of a pairing."""
    whole = isinstance(pairing, (list, tuple)) and all(
        isinstance(pair, (list, tuple)) and len(pair) == 2 for pair in pairing
    )
    if not whole or not pairing:
        raise InputError(
            "pairing", pairing, "at least one pair (output, input)", "pair output and input"
        )
    outputs, inputs = zip(*pairing, strict=True)
    model.select(outputs, inputs)
    return outputs, inputs
