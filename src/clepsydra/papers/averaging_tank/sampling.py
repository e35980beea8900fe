"""Which sampling period, actuators and transport delay the document's designs bear."""

from __future__ import annotations

import dataclasses
import math
from functools import cache
from pathlib import Path

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.designs.states.state_controllers import lqi_controller
from clepsydra.linear.analysis import analyse
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.papers.averaging_tank.continuous_pi import Constants
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, PRINTED_Q3, gains
from clepsydra.papers.averaging_tank.model import KMOL
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL, pi_controller
from clepsydra.papers.averaging_tank.step_run import model_of
from clepsydra.papers.averaging_tank.symbols import Variant
from clepsydra.papers.comparison import remark
from clepsydra.papers.row import Row
from clepsydra.process.reader import load_process

#: A usual cycle of a programmable logic controller [s].
CYCLE = 0.01
_LONGEST, _SHORTEST, _HALVINGS = 10.0, 1e-5, 16
_VARIANTS: tuple[Variant, Variant] = ("outflow", "inflow")
_TUNINGS = ("by hand", "optimal")
_LAWS = ("PI", "LQI")
#: The optimal LQI with Q3 of (101a) as it is printed.
_PRINTED = "as printed"


def sampling_rows() -> list[Row]:
    """Return the remarks on the sampling period, and on actuators and transport delay."""
    periods = [
        f"{law} {tuned}, f_{constant[:-4]} constant: "
        f"{_milliseconds(longest_period(constant, law, tuned))} ms"
        for constant in _VARIANTS
        for law in _LAWS
        for tuned in _TUNINGS
    ]
    peaks = []
    for law in _LAWS:
        controller = _controller("outflow", law, "by hand", CYCLE)
        without = peak(controller, model_of("outflow", CYCLE))
        renamed = tuple(
            {"inflow.impurity": "supply.impurity"}.get(name, name)
            for name in controller.manipulated
        )
        found = peak(dataclasses.replace(controller, manipulated=renamed), with_actuators())
        peaks.append(f"{law}: {_words(found)}, {_words(without)} without them")
    return [
        remark(
            "section 5", "sampling",
            "An average Programmable Logic Controller (PLC) would be sufficient hardware",
            "; ".join(periods),
            reason="Longest sampling period at which the linear model under the sampled law is "
            f"stable, inputs held and errors summed up to the one before; {1e3 * CYCLE:g} ms is a "
            "usual cycle. LQI optimal, f_in constant, has Q3 of (101a) as 10.92, see there; as "
            f"printed, 0.1092, it is {_milliseconds(longest_period('inflow', 'LQI', _PRINTED))} "
            "ms. With the present error in the sum PI optimal bears "
            f"{_milliseconds(longest_with_present_error(OPTIMAL['outflow']))} and "
            f"{_milliseconds(longest_with_present_error(OPTIMAL['inflow']))} ms. The document says "
            "of PID and IC what hardware they need, and no sampling period.",
        ),
        remark(
            "section 5", "actuators and transport delay", "should be considered in the model",
            "; ".join(peaks),
            reason="A pump with a lag of 0.5 s and a pipe of 0.5 s, both ours, constants by hand "
            f"at {1e3 * CYCLE:g} ms with f_out constant. The pipe delays flow and concentration, "
            "as a channel does; one that is always full delays the concentration alone, and PI is "
            "unstable with it too, LQI is not.",
        ),
    ]  # fmt: skip


@cache
def with_actuators() -> LinearModel:
    """Return the linear model of the tank behind a pump with a lag and a pipe.

    Examples
    --------
    >>> with_actuators().inputs
    ('inflow', 'supply.impurity')
    """
    return analyse(load_process(str(Path(__file__).with_name("with_actuators.toml")))).model


def longest_period(constant: Variant, law: str, tuned: str) -> float:
    """Return up to which sampling period a design's loop is stable [s], by halving the interval.

    Examples
    --------
    PI control of V, an integrator, is stable while Kp Δt²/Ti − 2 Kp Δt + 4 > 0, up to
    (2 − √3) s with Kp = 8 1/s and Ti = 2 s:

    >>> abs(longest_period("outflow", "PI", "by hand") - (2 - 3**0.5)) < 1e-4
    True
    """
    low, high = math.log(_SHORTEST), math.log(_LONGEST)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _is_stable(constant, law, tuned, math.exp(middle)):
            low = middle
        else:
            high = middle
    return math.exp(low)


def longest_with_present_error(constants: Constants) -> float:
    """Return up to which sampling period C is stable [s] if the integral has the present error.

    C under PI control, with α = exp(-Δt/10 s) and k = (1 - α) Kp, has the characteristic
    polynomial z² + (k (1 + Δt/Ti) - 1 - α) z + α - k. It is stable while 2 (1 + α) >
    k (2 + Δt/Ti) and k < 1 + α; the second follows from the first.

    Examples
    --------
    >>> round(longest_with_present_error(OPTIMAL["outflow"]), 4)
    0.0203
    """
    from scipy.optimize import brentq

    def room(period: float) -> float:
        alpha = math.exp(-period / 10.0)
        k = (1.0 - alpha) * constants.gain_c
        return 2.0 * (1.0 + alpha) - k * (2.0 + period / constants.time_c)

    return float(brentq(room, _SHORTEST, _LONGEST))


def peak(controller: Controller, model: LinearModel) -> float:
    """Return the largest |S| of the sampled loop; infinite where it is unstable."""
    return SampledLoops(controller, model).at(controller.values).maximum_sensitivity


def _is_stable(constant: Variant, law: str, tuned: str, period: float) -> bool:
    model = _sampled(model_of(constant), period)
    controller = _controller(constant, law, tuned, CYCLE)
    return SampledLoops(controller, model).at(controller.values).is_stable


@cache
def _controller(constant: Variant, law: str, tuned: str, period: float) -> Controller:
    model = model_of(constant, period)
    if law == "PI":
        constants = (BY_HAND if tuned == "by hand" else OPTIMAL)[constant]
        return pi_controller(constants, model)
    if tuned == _PRINTED:
        weights = PRINTED_Q3
    else:
        weights = COLUMNS[2 * _VARIANTS.index(constant) + _TUNINGS.index(tuned)]
    to_input, from_output = np.array([1.0, KMOL]), np.array([KMOL, 1.0])
    scaled = gains(weights).reshape(2, 2, 2) * to_input[:, None, None] / from_output
    measured = ("concentration", "volume")
    return lqi_controller("LQI", model, measured, scaled[:, 0], scaled[:, 1], [1.0, 1.0], "none")


def _sampled(model: LinearModel, period: float) -> LinearModel:
    """Return the model sampled with another period [s]."""
    point = operating_point_of(model)
    process = dataclasses.replace(point.process, sampling_period=period)
    return dataclasses.replace(model, point=dataclasses.replace(point, process=process))


def _words(peak: float) -> str:
    return f"largest |S| {peak:.2f}" if math.isfinite(peak) else "unstable"


def _milliseconds(period: float) -> str:
    return f"{float(f'{1e3 * period:.3g}'):g}"
