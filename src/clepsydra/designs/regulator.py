"""A controller from a linear regulator that was designed elsewhere, as four matrices."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from clepsydra.base.arguments import check_choice, require_type, sequence_of
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import to_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import check_signals
from clepsydra.designs.applicability import told_by
from clepsydra.designs.loop_shaping.conditioning import linear_controller, told_by_own_observer
from clepsydra.designs.loop_shaping.precompensator import Precompensator
from clepsydra.designs.loop_shaping.shaped_plant import shaped_plant
from clepsydra.designs.regulators.given import METHOD, GivenRegulator, given_regulator
from clepsydra.designs.regulators.mat_file import read_mat
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.designs.slowing_down import note_on_peak
from clepsydra.designs.states.state_controllers import sensitivity_peak
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.process import Process

FAMILY = "given regulator"
#: What its inputs are: r − y, as in u = F (r − y), or y − r, as in u = K y of an estimator.
ActsOn = Literal["setpoint_minus_measurement", "measurement_minus_setpoint"]
#: Whether its states are told what was applied, or wind up.
RegulatorAntiWindup = Literal["conditioning", "none"]
_SINGULAR = 1e12


def regulator_controller(
    model: LinearModel,
    regulator: Any,
    *,
    sampling_period: float | None = None,
    measurements: Sequence[str] | None = None,
    manipulated: Sequence[str] | None = None,
    units: Mapping[str, str] | None = None,
    acts_on: ActsOn = "setpoint_minus_measurement",
    anti_windup: RegulatorAntiWindup = "conditioning",
    name: str = "Regulator",
) -> Controller:
    """Return a controller with the matrices of a regulator, at rest at the operating point.

    x' = A x + B e, u = u° + C x + D e with the errors e = r − y. A regulator in continuous time
    is sampled by Tustin's rule, s = 2/T (z − 1)/(z + 1): an integral stays one, gains are those
    at s(z), and no half sample of delay is added to the direct way D, as there would be with the
    errors held. One that is sampled already has to have the sampling period of the process.

    The numbers are in the units that people see of the signals, with `units` in others. Its
    states are told the output that was applied by an observer of the regulator itself
    (`controllers.conditioned_linear`), so that it neither winds up nor bumps.

    Parameters
    ----------
    regulator : str, Path, sequence of four matrices, or object
        A MAT file with A, B, C and D; (A, B, C, D) themselves; or a StateSpace of python-control
        or SciPy.
    sampling_period : float, optional
        Of a regulator that is sampled already, and does not say so itself [s].
    measurements, manipulated : sequence of str, optional
        The signals of its inputs and outputs, in its order; those that the process controls and
        all its inputs if left out.
    units : mapping, optional
        Unit of the numbers of a signal, {"level_1": "cm", "pump_1": "%"}, a % being of the range;
        the display unit if left out.
    acts_on : {"setpoint_minus_measurement", "measurement_minus_setpoint"}
        What its inputs are.
    anti_windup : {"conditioning", "none"}
        With "none" its states know nothing of limits, as in a simulation that has no anti-windup.
    name : str
        What the reader sees.

    Raises
    ------
    InputError
        The regulator or a matrix of it is wrong, it does not fit the signals or the sampling
        period, a signal or unit is unknown, or the model has no operating point.
    NotApplicable
        A mode of it that does not die out is not reached or not shown, the process has a direct
        way or too much dead time, or a number is outside of what a controller takes.

    Examples
    --------
    PI control of one level, K = 3 and Ti = 30 s in V/V, as four matrices:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = regulator_controller(
    ...     plant.linear, (0.0, 0.1, 1.0, 3.0), measurements=["level_1"], manipulated=["pump_1"])
    >>> round(controller.values["pump_1.error_gain.level_1"], 6)  # of y − r; 3 + 0.1 · 1 s / 2
    -3.05
    """
    point = operating_point_of(model)
    process, period = point.process, point.process.sampling_period
    check_choice(f"{METHOD}, acts_on", acts_on, get_args(ActsOn))
    check_choice(f"{METHOD}, anti_windup", anti_windup, get_args(RegulatorAntiWindup))
    if isinstance(regulator, (str, Path)):
        regulator = read_mat(regulator)
    given = given_regulator(regulator, sampling_period)
    measured, moved = _signals(process, given, measurements, manipulated)
    A, B, C, D = _sampled(given, process)
    # From y − r to Δu in SI, and from r − y as a pre-compensator is.
    inputs, outputs = _scales(measured, moved, units)
    sign = 1.0 if acts_on.startswith("measurement") else -1.0
    system = SampledSystem(
        A, sign * B / inputs, outputs[:, None] * C, sign * outputs[:, None] * D / inputs
    )
    errors = system._replace(B=-system.B, D=-system.D)
    ys, us = (tuple(signal.name for signal in each) for each in (measured, moved))
    with told_by(METHOD):
        plant = shaped_plant(model, Precompensator(name, errors, ys, us))
        spans = np.array([each.span if math.isfinite(each.span) else 1.0 for each in moved])
        matrices = told_by_own_observer(system, plant.sizes, spans)
    notes = [
        "A fault of any of its sensors holds every output.",
        f"Its matrices hold for a sampling period of {period:g} s and no other.",
    ]
    made, told = f"sampled each {period:g} s", "its states are told what was applied"
    if given.period is None:
        made = f"in continuous time, sampled by Tustin's rule each {period:g} s"
        fast = int(np.sum(np.abs(np.linalg.eigvals(given.A)) * period > math.pi))
        if fast:
            notes.append(
                f"{fast} of its poles are faster than half of the sampling rate, "
                f"{math.pi / period:.3g} rad/s: sampled, the regulator is another one there."
            )
    if anti_windup == "none":
        matrices, told = matrices.unconditioned(), "no anti-windup"
        notes.append("It winds up: its states know nothing of a limit or of manual.")
    found = linear_controller(point, name, FAMILY, measured, moved, matrices, plant)
    peak = sensitivity_peak(found, model)
    stable = f"sensitivity peak {peak:.2f}"
    if math.isinf(peak):
        stable = "the loop is unstable"
        notes.append(
            "The sampled loop is unstable at the operating point: look at the units, at the sign "
            "and at the order of the signals."
        )
    else:
        notes += note_on_peak(peak, "see whether units, signs and signals are right")
    source = "" if given.place == METHOD else f" from {Path(given.place).name}"
    words = f"A regulator of order {len(given.A)} given{source}, {made}; {told}; {stable}."
    return found.described(words, notes)


def _signals(
    process: Process,
    given: GivenRegulator,
    measurements: Sequence[str] | None,
    manipulated: Sequence[str] | None,
) -> tuple[list[Signal], list[Signal]]:
    """Return the signals of its inputs and outputs, as many as it has."""
    outputs, inputs = given.D.shape
    found = []
    for key, names, usual, count, ends in (
        ("measurements", measurements, list(process.controlled), inputs, "inputs"),
        ("manipulated", manipulated, [each.name for each in process.inputs], outputs, "outputs"),
    ):
        place, expected = f"{METHOD}, {key}", f"{count} names, one for each of its {ends}"
        remedy = f'name them in its order, as in ["{usual[0]}"]'
        chosen = sequence_of(usual if names is None else names, str, place, expected, remedy)
        if len(chosen) != count or len(set(chosen)) != count:
            raise InputError(place, ", ".join(chosen) or "none", expected, remedy)
        found.append(chosen)
    check_signals(found[0], found[0], found[1], METHOD, process)
    if inputs > outputs:
        place, shown = f"{METHOD}, measurements", f"{inputs} for {outputs} manipulated"
        expected = "no more measurements than manipulated variables: each brings a setpoint"
        raise InputError(place, shown, expected, "give a regulator of fewer errors")
    measured, moved = ([process.signal(name) for name in each] for each in found)
    return measured, moved


def _sampled(given: GivenRegulator, process: Process) -> SampledSystem:
    """Return it at the sampling period of the process, in its own units and signs."""
    period = process.sampling_period
    matrices = given.A, given.B, given.C, given.D
    if given.period is not None:
        if not math.isclose(given.period, period, rel_tol=1e-9):
            place = f"{given.place}, sampling period"
            expected = f"{period:g} s, that of {process.name}"
            remedy = "give the process that sampling_period, or the regulator in continuous time"
            raise InputError(place, f"{given.period:g} s", expected, remedy)
        return SampledSystem(*matrices)
    if np.linalg.cond(np.eye(len(given.A)) - 0.5 * period * given.A) > _SINGULAR:
        shown = f"a pole at {2.0 / period:.3g} rad/s"
        remedy = "sample faster, or give a regulator that is sampled already"
        raise InputError(f"{given.place}, A", shown, "no pole at 2/T", remedy)
    return SampledSystem.by_tustins_rule(matrices, period)


def _scales(
    measured: Sequence[Signal], moved: Sequence[Signal], units: Mapping[str, str] | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return what one unit of its inputs and outputs is in SI."""
    example = 'write as in {"level_1": "cm"}'
    require_type(units or {}, Mapping, f"{METHOD}, units", "signals with their units", example)
    known = {signal.name: signal for signal in (*measured, *moved)}
    asked = {name: signal.shown_unit for name, signal in known.items()}
    for name, unit in (units or {}).items():
        if name not in known:
            expected = f"a signal of it: {', '.join(known)}"
            raise InputError(f"{METHOD}, units", name, expected, "correct the name")
        asked[name] = unit
    inputs, outputs = (
        np.array([_scale(signal, asked[signal.name]) for signal in each])
        for each in (measured, moved)
    )
    return inputs, outputs


def _scale(signal: Signal, unit: object) -> float:
    if unit == "%" and signal.has_range:
        return signal.percent_span / 100.0
    if isinstance(unit, str):
        with suppress(InputError):  # what it says is of a quantity
            return to_si(f"1 {unit}", signal.unit, METHOD)
    expected = f"a unit of {signal.name}, which is in {signal.shown_unit}"
    example = f'write as in "{signal.shown_unit}"'
    raise InputError(f"{METHOD}, units, {signal.name}", unit, expected, example)
