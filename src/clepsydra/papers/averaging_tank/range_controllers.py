"""PI and LQI for large steps, scheduled and recomputed, and what they do on the linear model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.gain_scheduling import Schedule, scheduled_law, scheduled_lqi_law
from clepsydra.controllers.observers.state_source import MeasuredState
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.recomputed_lqi import recomputed_lqi_controller
from clepsydra.designs.sampled.sampled_process import held_over
from clepsydra.designs.states.bryson_rule import bryson_weights
from clepsydra.designs.states.linear_quadratic import lqi_gains
from clepsydra.designs.states.process_filter import acting_model
from clepsydra.designs.states.state_controllers import lqi_controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.process_equations import process_equations
from clepsydra.loop.loop import Loop
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, Weights, in_moles, weighed
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.averaging_tank.pi import BY_HAND, pi_controller
from clepsydra.papers.averaging_tank.step_run import model_of
from clepsydra.papers.averaging_tank.symbols import FLOW, V0, Variant
from clepsydra.program.step_law import StepLaw

#: The loops of the document, and what its conclusion asks for.
_LAWS = ("PI", "LQI", "PI, scheduled", "LQI, scheduled", "LQI, recomputed")
KINDS = tuple(f"{law}{ending}" for law in _LAWS for ending in ("", ", anti-windup"))
#: Volumes of the schedule [m³].
VOLUMES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0)
#: In this time the recomputed model follows the inputs, ours [s]: T = V/f_in at the equilibrium.
_FOLLOWS = 10.0
_MEASURED = ("concentration", "volume")


@cache
def controller_of(constant: Variant, kind: str, period: float) -> Controller:
    """Return one of `KINDS` for a sampling period [s]."""
    law = kind.removesuffix(", anti-windup")
    winding: AntiWindup = "back_calculation" if kind.endswith("anti-windup") else "none"
    model = model_of(constant, period, high=True)
    if law.startswith("PI"):
        plain = pi_controller(BY_HAND[constant], model, PidForm(anti_windup=winding))
        if winding == "back_calculation":
            times = BY_HAND[constant].time_c, BY_HAND[constant].time_v
            names = (path(name, "tracking_time") for name in _MEASURED)
            plain = replace(plain, values={**plain.values, **dict(zip(names, times, strict=True))})
        return plain if law == "PI" else _scheduled_pi(plain, model, period)
    weights = COLUMNS[0 if constant == "outflow" else 2]
    if law == "LQI":
        return lqi_controller(kind, model, _MEASURED, *gains_at(weights, V0), [1.0, 1.0], winding)
    if law == "LQI, scheduled":
        return _scheduled_lqi(weights, model, period, winding)
    return _recomputed_lqi(weights, model, period, winding)


@cache
def gains_at(weights: Weights, volume: float) -> tuple[np.ndarray, np.ndarray]:
    """Return F and Fi at a volume [m³], from the Riccati equation of (87), C in mol/m³."""

    sign = 1.0 if weights.constant == "outflow" else -1.0
    A, B = np.diag([-FLOW / volume, 0.0]), np.array([[0.0, FLOW / volume], [sign, 0.0]])
    found = weighed(weights, A, B) + 0.0
    found[np.abs(found) < 1e-9] = 0.0
    return in_moles(found)


def _scheduled_pi(plain: Controller, model: LinearModel, period: float) -> Controller:
    """Return PI control whose gain of C is in proportion to the volume, as its element 1/V asks."""
    schedule, gain = _schedule(model), "concentration.proportional_gain"
    law = scheduled_law(plain.law, schedule, [gain])
    tables = {gain: [plain.values[gain] * volume / V0 for volume in VOLUMES]}
    return _rescheduled(replace(plain, name="PI, scheduled"), model, law, period, tables)


def _scheduled_lqi(
    weights: Weights, model: LinearModel, period: float, winding: AntiWindup
) -> Controller:
    plain = lqi_controller(
        "LQI, scheduled", model, _MEASURED, *gains_at(weights, V0), [1.0, 1.0], winding
    )
    signal, moved = operating_point_of(model).process.signal, plain.manipulated
    law = scheduled_lqi_law(
        list(map(signal, _MEASURED)), list(map(signal, moved)), _MEASURED, _schedule(model), winding
    )
    found = [gains_at(weights, volume) for volume in VOLUMES]
    tables = {
        path(path(output, what), name): [float(gains[place][i, j]) for gains in found]
        for place, what in enumerate(("feedback", "integral_gain"))
        for i, output in enumerate(moved)
        for j, name in enumerate(_MEASURED)
    }
    if winding == "back_calculation":
        tables |= {path(output, "tracking_time"): [1.0] * len(VOLUMES) for output in moved}
    return _rescheduled(plain, model, law, period, tables)


def _schedule(model: LinearModel) -> Schedule:
    signal = operating_point_of(model).process.signal("volume")
    return Schedule("volume.pv", signal, len(VOLUMES))


def _rescheduled(
    plain: Controller,
    model: LinearModel,
    law: StepLaw,
    period: float,
    tables: Mapping[str, Sequence[float]],
) -> Controller:
    """Return a controller of fixed gains whose law has tables over the volume instead."""
    schedule, known = _schedule(model), {parameter.name for parameter in law.parameters}
    values = {name: value for name, value in plain.values.items() if name in known}
    places = [*schedule.places, "schedule.filter_time"]
    values |= zip(places, (*VOLUMES, period), strict=True)
    for name, table in tables.items():
        values |= zip(schedule.values(name), table, strict=True)
    state = state_at_rest(law, values, operating_point_of(model).as_dict())
    return replace(plain, law=law, values=values, initial_state=state)


def _recomputed_lqi(
    weights: Weights, model: LinearModel, period: float, winding: AntiWindup
) -> Controller:
    """Return LQI with the document's weights as largest deviations: q is 1/ȳ² and 1/(ȳ T)²."""
    equations = process_equations(model)
    q = np.array(weights.states)
    errors = q[:2] ** -0.5 * np.array([KMOL, 1.0])
    horizons = np.sqrt(q[:2] / q[2:])
    moves = np.array(weights.inputs) ** -0.5 * np.array([1.0, KMOL])
    acting = acting_model(model, equations)
    weighed = bryson_weights(acting, errors, moves, horizons)
    return recomputed_lqi_controller(
        MeasuredState(equations),
        lqi_gains(acting, weighed, period, float(horizons.max())),
        winding,
        largest_error=errors,
        largest_move=moves,
        horizon=horizons,
        input_filter_time=_FOLLOWS,
        tracking_time=1.0,
    )


def linear_errors(
    controller: Controller,
    model: LinearModel,
    sizes: Sequence[tuple[float, float]],
    horizon: float,
) -> np.ndarray:
    """Return ∫ |e| dt of C and V [2, n] after n steps of both, in the process's linear model.

    The inputs keep their limits, so that what is left of a decline is no nonlinearity of the
    process. Held over each sample the linear model is exact.
    """
    loop, law, factors = Loop(controller, model), controller.law, np.array([[KMOL], [1.0]])
    period = loop.process.sampling_period
    seen, now = model.select(_MEASURED, controller.manipulated), loop.point.as_dict()
    held, moved = held_over(seen.A, seen.B, period)
    y, u = (np.array([[now[name]] for name in names]) for names in (seen.outputs, seen.inputs))
    targets = y + factors * np.array(sizes).T
    now |= loop.at_rest()
    now |= zip([f"{name}.setpoint" for name in _MEASURED], targets, strict=True)
    given, wires = loop.law_inputs(now), controller.output_wires
    # Law and process have one unit here, SI.
    read = [
        [controller.input_wires.get(signal.name) for signal in law.inputs].index(name)
        for name in _MEASURED
    ]
    told = [[wires[signal.name] for signal in law.outputs].index(name) for name in seen.inputs]
    equations = law.function.map(len(sizes))
    parameters = np.array([[controller.values[each.name]] for each in law.parameters])
    state = np.array([[controller.initial_state[each.name]] for each in law.state])
    parameters, state = (np.tile(each, len(sizes)) for each in (parameters, state))
    x, errors = np.zeros((len(seen.states), len(sizes))), []
    for _ in range(round(horizon / period) + 1):
        given[read] = y + seen.C @ x
        errors.append(np.abs(targets - given[read]) / factors)
        state, outputs, _ = equations(state, given, parameters)
        x = held @ x + moved @ (np.array(outputs)[told] - u)
    return np.trapezoid(errors, dx=period, axis=0)
