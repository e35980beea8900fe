"""With which state a loop starts: at rest, or after its first samples at the operating point."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.base.units import from_si
from clepsydra.controllers.blocks.status import Mode
from clepsydra.engine.law_evaluation import LawEvaluation
from clepsydra.program.entries import Entry
from clepsydra.program.step_law import StepLaw

#: A move below this share of the range is rounding.
_STILL = 1e-6
#: So many samples show a move that an integral begins.
_SAMPLES = 3


def scanned(
    law: StepLaw,
    values: Mapping[str, float],
    state: Mapping[str, float],
    *scans: Mapping[str, float],
) -> tuple[dict[str, float], dict[str, float]]:
    """Return state and outputs of a law after some scans, of each of which the inputs are given."""
    parameters = np.array([values[parameter.name] for parameter in law.parameters])
    run = LawEvaluation(law, parameters, np.array([state[entry.name] for entry in law.state]))
    for given in scans:
        outputs = run.step(np.array([given[signal.name] for signal in law.inputs]))
    return _by_name(law.state, run.state), _by_name(law.outputs, outputs)


def _by_name(entries: Iterable[Entry], values: np.ndarray) -> dict[str, float]:
    return dict(zip((entry.name for entry in entries), values.tolist(), strict=True))


def first_samples(
    law: StepLaw,
    values: Mapping[str, float],
    state: Mapping[str, float],
    inputs: Mapping[str, float],
    manipulated: Sequence[Signal],
    period: float,
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Return the state with which a controller begins, and a note for each output that moves.

    Where its outputs stay, it begins with the state after a few samples at the operating point:
    loops that wait before a
    selector then ask for something else than the one that is selected, as they do ever after.
    Where an output moves, an override is active there, or a ratio asks for another value than
    the one at rest.

    `inputs`: sp, pv and tracking of the signals at the operating point, and the free inputs;
    `period`: of the samples [s].

    Examples
    --------
    A setpoint that the measurement is not at: the integral moves by K e Δt/Ti a sample.

    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> law = multiloop_pid_law(["level"], [pump])
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> inputs = {"level.sp": 5.0, "level.pv": 4.0, "pump_1.tracking": 3.0}
    >>> state = state_at_rest(law, values, inputs)
    >>> first_samples(law, values, state, inputs, [pump], 1.0)[1][0][:68]
    'At the operating point it moves pump_1 from 3 V to 3.03333 V in 3 sa'
    """
    given = {signal.name: signal.initial for signal in law.inputs} | dict(inputs)
    given |= {path(signal, "mode"): float(Mode.AUTOMATIC) for signal in manipulated}
    given |= {"time_step": period}
    settled, found = scanned(law, values, state, *[given] * _SAMPLES)
    notes = []
    for signal in manipulated:
        before, after = given[path(signal, "tracking")], found[path(signal, "out")]
        size = signal.span if math.isfinite(signal.span) else max(abs(before), 1.0)
        if abs(after - before) > _STILL * size:
            first, last = (
                f"{from_si(each, signal.unit, signal.shown_unit):.6g} {signal.shown_unit}"
                for each in (before, after)
            )
            notes.append(
                f"At the operating point it moves {signal.name} from {first} to {last} in "
                f"{_SAMPLES} samples: the scenario does not begin at rest."
            )
    return (dict(state), tuple(notes)) if notes else (settled, ())


#: So long lasts a scan that every filter comes to its end in [s].
_FOR_EVER = 1e15
_SCANS = 12


def state_at_rest(
    law: StepLaw, values: Mapping[str, float], at: Mapping[str, float]
) -> dict[str, float]:
    """Return the state of a law after it tracked the outputs of an operating point for ever.

    In tracking every memory of a law follows: integrals, filters, the setpoints of inner loops.
    So a few scans with a very long time step bring it to rest, whatever blocks it is made of.

    `values`: parameter name to value; `at`: of the operating point: inputs of the law by name, or
    process signals, of which each is the pv, sp and tracking that belong to it. Any other input has
    its initial value.

    Examples
    --------
    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level"], ["pump"])
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> state_at_rest(law, values, {"level": 5.0, "pump": 3.0})
    {'level.integral': 3.0, 'level.last_proportional_gain': 1.0, 'level.last_setpoint_weight': \
1.0, 'pump.last_output': 3.0}
    """
    of_process = [signal for signal in law.inputs if signal.part in ("sp", "pv", "tracking")]
    given = {signal.name: signal.initial for signal in law.inputs}
    given |= {signal.name: at.get(signal.owner, signal.initial) for signal in of_process}
    given |= dict(at)
    given |= {s.name: float(Mode.TRACKING) for s in law.inputs if s.part == "mode"}
    given |= {"time_step": _FOR_EVER}
    began = {e.name: e.initial if isinstance(e, Signal) else 0.0 for e in law.state}
    return scanned(law, values, began, *[given] * _SCANS)[0]
