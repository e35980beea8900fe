"""Section 3.1.3 and Table 6: PI control, by hand, as printed and tuned by minimax, and Fig. 7."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import product

from clepsydra.base.signal import path
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.pid_form import Actions, PidForm
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.continuous_pi import (
    HIGHEST_FLOW,
    HIGHEST_INLET,
    Constants,
    continuous_run,
)
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.averaging_tank.step_run import (
    STEPS,
    model_of,
    step_run,
    step_scenario,
    trend_figure,
)
from clepsydra.papers.averaging_tank.symbols import VARIANTS, Variant, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.row import Rows, joined
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Objective
from clepsydra.studies.tuning.parameters import TunedParameter
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import Search, tune

BY_HAND, OPTIMAL = (
    {
        variant: Constants(variant, tuned, *PRINTED.numbers(place, "K_pC", "T_iC", "K_pV", "T_iV"))
        for variant, place in zip(VARIANTS, places, strict=True)
    }
    for tuned, places in (("by hand", ("(80)", "(82)")), ("optimal", ("(81)", "(83)")))
)
_CONTROLLED = ("concentration", "volume")
#: C_in of Table 6 has no limit, see `pi_claims` [mol/m³].
_FREE = 1e9
_TUNING_PERIOD, _TUNING_HORIZON = 2e-3, 20.0  # [s]
#: Of Fig. 7: held over the document's 0.2 ms, the loop of (81) would be another one [s].
_DRAWN_PERIOD, _DRAWN = 2e-5, 4.0
#: IE of V that is called zero: not a billionth of its IAE [m³ s].
_NO_ERROR = 1e-11
#: An integral time that is as good as none, and a derivative time [s].
_NO_INTEGRAL, _NO_DERIVATIVE = 1e7, 1e-5
#: What is tuned [1, 1/s, s], between which bounds.
_BOUNDS = {
    "concentration.proportional_gain": (0.5, 500.0),
    "concentration.integral_time": (1e-3, _NO_INTEGRAL),
    "concentration.derivative_time": (_NO_DERIVATIVE, 1.0),
    "volume.proportional_gain": (0.05, 80.0),
    "volume.integral_time": (1e-2, _NO_INTEGRAL),
    "volume.derivative_time": (_NO_DERIVATIVE, 1.0),
}
#: The type that each type contains: its optimum is a start as well.
_CONTAINED: dict[Actions, Actions] = {"PI": "P", "PID": "PI"}


def run() -> Found:
    """Return the rows on PI control, and Fig. 7."""
    yield from (*_signed_error(), *_table_6())
    runs = {}
    for constants in (each[variant] for variant in VARIANTS for each in (BY_HAND, OPTIMAL)):
        model = model_of(constants.constant, _DRAWN_PERIOD)
        runs[constants.title] = step_run(pi_controller(constants, model), model, horizon=_DRAWN)
    yield trend_figure(
        "Fig. 7", "Steps of both references under PI control", runs, _DRAWN,
        "With the printed optimum C_in swings between its limits: an integral time of a "
        "millisecond makes IE small and the loop ring.",
    )  # fmt: skip


def pi_controller(
    constants: Constants,
    model: LinearModel,
    form: PidForm | None = None,
    *,
    free: bool = False,
    settings: Mapping[str, float] | None = None,
) -> Controller:
    """Return PI (or P, PID) control of C by C_in and of V by a flow, on deviations as in (35).

    Without a form it has no anti-windup, as in the document; `free` lets C_in go without limits,
    and `settings` stand in the place of those that follow from the constants.
    """
    flow = "inflow" if constants.constant == "outflow" else "outflow"
    moved = ("inflow.impurity", flow)
    law = multiloop_pid_law(_CONTROLLED, moved, form or PidForm(anti_windup="none"))
    # Concentrations in mol: the gain of C has no unit of amount.
    given = {
        **_settings(constants),
        "concentration.setpoint_weight": 1.0,
        "volume.setpoint_weight": 1.0,
        "inflow.impurity.low_limit": -_FREE if free else 0.0,
        "inflow.impurity.high_limit": _FREE if free else HIGHEST_INLET * KMOL,
        path(flow, "low_limit"): 0.0,
        path(flow, "high_limit"): HIGHEST_FLOW,
        **(settings or {}),
    }
    values = {each.name: given.get(each.name, each.initial) for each in law.parameters}
    state = state_at_rest(law, values, operating_point_of(model).as_dict())
    return Controller(
        f"PI, {constants.tuned}", "multiloop PI", "Constants of the document.", law, values,
        state, _CONTROLLED, _CONTROLLED, moved,
    )  # fmt: skip


def _settings(constants: Constants) -> dict[str, float]:
    """Return settings of PI control by name; f_out acts on V the other way."""
    return {
        "concentration.proportional_gain": constants.gain_c,
        "concentration.integral_time": constants.time_c,
        "volume.proportional_gain": constants.gain_v * (-1.0) ** (constants.constant == "inflow"),
        "volume.integral_time": constants.time_v,
    }


def _signed_error() -> Rows:
    """IE, integrated with the loop, and the relation that it has to keep."""
    against = "The cell and (83) contradict each other, and nothing tells which is wrong."
    for output, variant in product(("C", "V"), VARIANTS):
        line = PRINTED["Table 6", f"IE of {output}, {constant_flow(variant)}"]
        found = continuous_run(OPTIMAL[variant], free=True).indices["IE", output]
        if output == "C":
            yield line.compared(found, unprinted=joined(line.note, against))
        else:
            yield line.compared(found, zero=_NO_ERROR)


@cache
def tuned(variant: Variant, index: str) -> Constants:
    """Return the constants that minimise the larger index of C and V, from those by hand."""
    values = minimax_tuned(variant, index, "PI").controller.values
    return Constants(
        variant, f"tuned for {index}",
        values["concentration.proportional_gain"], values["concentration.integral_time"],
        abs(values["volume.proportional_gain"]), values["volume.integral_time"],
    )  # fmt: skip


@cache
def minimax_tuned(variant: Variant, index: str, actions: Actions) -> TuningResult:
    """Minimise the larger index of C and V over the settings of a type of controller.

    Local searches, as the document's is one: from the constants by hand, from the largest gains
    without integral action on V, which integrates by itself, and from the optimum of the type
    that it contains, so that no type is worse than one that it contains. C_in has no limits.
    """
    hand = _settings(BY_HAND[variant]) | {path(y, "derivative_time"): 1e-3 for y in _CONTROLLED}
    starts = [hand]
    if actions in _CONTAINED:
        least = minimax_tuned(variant, index, _CONTAINED[actions]).controller.values
        without = {path(y, "integral_time"): _NO_INTEGRAL for y in _CONTROLLED}
        without |= {path(y, "derivative_time"): _NO_DERIVATIVE for y in _CONTROLLED}
        gains = [path(y, "proportional_gain") for y in _CONTROLLED]
        fastest = {name: _BOUNDS[name][1] for name in gains}
        fastest["volume.proportional_gain"] *= 1.0 if variant == "outflow" else -1.0
        starts.append(hand | fastest | {"volume.integral_time": _NO_INTEGRAL})
        starts.append(without | {name: least[name] for name in _BOUNDS if name in least})
    found = [_tuned_from(start, variant, index, actions) for start in starts]
    return min(found, key=lambda each: each.objective)


def _tuned_from(
    start: Mapping[str, float], variant: Variant, index: str, actions: Actions
) -> TuningResult:
    model = without_limit(model_of(variant, _TUNING_PERIOD))
    form = PidForm(actions, derivative_on="error", anti_windup="none")
    filters = {path(y, "derivative_filter"): 10.0 for y in _CONTROLLED}
    controller = pi_controller(
        BY_HAND[variant], model, form, free=True, settings={**start, **filters}
    )
    score, factor = index.lower(), KMOL**-2 if index == "ISE" else 1.0 / KMOL
    bounds = [
        # f_out acts the other way.
        TunedParameter(name, -high, -low)
        if name == "volume.proportional_gain" and variant == "inflow"
        else TunedParameter(name, low, high)
        for name, (low, high) in _BOUNDS.items()
        if name in controller.values
    ]
    scenario = step_scenario(model, (STEPS["C"], STEPS["V"]), _TUNING_HORIZON)
    weights = {f"{score}[concentration]": factor, f"{score}[volume]": 1.0}
    goal = Goal(model, scenario, Objective("minimax", weights, relative=False))
    return tune(LawSpace(controller, bounds), goal, Search(generations=0))


@cache
def without_limit(model: LinearModel) -> LinearModel:
    """Return a model whose C_in has no limits."""
    point = operating_point_of(model)
    inputs = tuple(
        replace(signal, low=-_FREE, high=_FREE) if signal.name == "inflow.impurity" else signal
        for signal in point.process.inputs
    )
    return replace(model, point=replace(point, process=replace(point.process, inputs=inputs)))


def _table_6() -> Rows:
    for index, variant in product(("IAE", "ISE", "ITAE"), VARIANTS):
        found = continuous_run(OPTIMAL[variant], free=True).indices
        cells = {f"{index} of {o}, {constant_flow(variant)}": found[index, o] for o in ("C", "V")}
        yield from PRINTED.compared("Table 6", cells)
