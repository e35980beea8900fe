"""What the designs of multiloop PI controllers share: pairing checked, controller made."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.proportional_integral import FAMILY, multiloop_pi_law
from clepsydra.design.applicability import NotApplicable
from clepsydra.design.element import Element, element
from clepsydra.design.input_room import check_ranges
from clepsydra.design.loop_transfer import PiSettings
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.process import Process

Pairing = Sequence[tuple[str, str]]


class PairedLoop(NamedTuple):
    """One pair: measurement, input, the element between them, and the input at rest."""

    output: str
    input_name: str
    element: Element
    resting_input: float


def paired_loops(
    process: Process, model: LinearModel, pairing: Pairing, method: str
) -> list[PairedLoop]:
    """Check a pairing against a process and its model, and return its loops.

    Raises
    ------
    InputError
        The pairing is empty, names an unknown signal, or one signal twice.
    NotApplicable
        The model has no operating point, a signal has no range, or an input does not move
        its output.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> analysis = analyse(process)
    >>> loops = paired_loops(process, analysis.model, analysis.pairing, "SIMC")
    >>> [(loop.output, loop.input_name, loop.resting_input) for loop in loops]
    [('level_1', 'pump_1', 3.0), ('level_2', 'pump_2', 3.0)]
    """
    if not pairing:
        raise InputError("pairing", list(pairing), "at least one pair", "pair output and input")
    model.select([pair[0] for pair in pairing], [pair[1] for pair in pairing])
    check_ranges(process, [pair[0] for pair in pairing], [pair[1] for pair in pairing], method)
    if model.point is None:
        raise NotApplicable(method, "the model does not come from an operating point")
    values = model.point.as_dict()
    loops = []
    for output, input_name in pairing:
        found = element(model, output, input_name)
        if found is None:
            raise NotApplicable(method, f"{input_name} does not move {output}")
        loops.append(PairedLoop(output, input_name, found, values[input_name]))
    return loops


def output_sizes(process: Process, loops: Sequence[PairedLoop]) -> list[float]:
    """Return the span of each loop's measurement.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.base.signal import Signal
    >>> process = SimpleNamespace(signal={"y": Signal("y", "V", low=1, high=5)}.__getitem__)
    >>> output_sizes(process, [PairedLoop("y", "u", Element(1.0, (-1.0,), (), 0), 2.0)])
    [4]
    """
    return [process.signal(loop.output).high - process.signal(loop.output).low for loop in loops]


def multiloop_pi(
    process: Process,
    model: LinearModel,
    loops: Sequence[PairedLoop],
    settings: Sequence[PiSettings],
    *,
    anti_windup: AntiWindup,
    method: str,
    design: str,
    notes: Sequence[str],
) -> Controller:
    """Return the controller with these settings, at rest at the model's operating point.

    The setpoint weight is 1, the tracking time the integral time, and the limits are the
    ranges of the inputs.

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> analysis = analyse(process)
    >>> loops = paired_loops(process, analysis.model, analysis.pairing, "by hand")
    >>> controller = multiloop_pi(
    ...     process, analysis.model, loops, [PiSettings(3.0, 30.0), PiSettings(2.7, 40.0)],
    ...     anti_windup="clamping", method="Johansson", design="Published.", notes=[])
    >>> controller.name, controller.values["integral_time_2"], controller.values["high_limit_2"]
    ('PI, Johansson', 40.0, 10.0)
    """
    if model.point is None:
        raise NotApplicable(method, "the model does not come from an operating point")
    at = model.point.as_dict()
    values: dict[str, float] = {}
    initial_state: dict[str, float] = {}
    for i, (loop, setting) in enumerate(zip(loops, settings, strict=True), start=1):
        signal = process.signal(loop.input_name)
        values |= {
            f"proportional_gain_{i}": setting.gain,
            f"integral_time_{i}": setting.integral_time,
            f"setpoint_weight_{i}": 1.0,
            f"low_limit_{i}": signal.low,
            f"high_limit_{i}": signal.high,
        }
        if anti_windup == "back_calculation":
            values[f"tracking_time_{i}"] = setting.integral_time
        # At rest r = y and b = 1, so the integral is the whole output.
        initial_state[f"integral_{i}"] = at[loop.input_name]
        initial_state[f"last_output_{i}"] = at[loop.input_name]
    outputs = tuple(loop.output for loop in loops)
    inputs = tuple(loop.input_name for loop in loops)
    return Controller(
        name=f"PI, {method}",
        family=FAMILY,
        design=design,
        law=multiloop_pi_law(
            len(loops),
            anti_windup,
            measured=[process.signal(name) for name in outputs],
            manipulated=[process.signal(name) for name in inputs],
        ),
        values=values,
        initial_state=initial_state,
        measurements=outputs,
        setpoints=outputs,
        manipulated=inputs,
        notes=tuple(notes),
    )


def settings_in_words(
    process: Process, loops: Sequence[PairedLoop], settings: Sequence[PiSettings]
) -> str:
    """Return the settings as a phrase.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from clepsydra.base.signal import Signal
    >>> signals = {"y": Signal("y", "V"), "u": Signal("u", "A")}
    >>> process = SimpleNamespace(signal=signals.__getitem__)
    >>> loop = PairedLoop("y", "u", Element(1.0, (-1.0,), (), 0), 2.0)
    >>> settings_in_words(process, [loop], [PiSettings(2.5, 30.0)])
    'y by u: K = 2.5 A/V, Ti = 30 s'
    """
    return "; ".join(
        f"{loop.output} by {loop.input_name}: K = {setting.gain:.3g} "
        f"{process.signal(loop.input_name).unit}/{process.signal(loop.output).unit}, "
        f"Ti = {setting.integral_time:.3g} s"
        for loop, setting in zip(loops, settings, strict=True)
    )
