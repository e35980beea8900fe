"""The controllers of the laboratory: decentralised PI, and Glover-McFarlane on top of it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.conditioned_linear import ConditionedMatrices, conditioned_linear_law
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import remembered_parameters
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.glover_mcfarlane import design_glover_mcfarlane
from clepsydra.designs.loop_shaping.precompensator import (
    Precompensator,
    precompensator_of,
)
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.linear.response import transfer_at
from clepsydra.papers.four_tank_laboratory.set_ups import MINIMUM, PHASE_MARGIN, SetUp, course_model
from clepsydra.process.process import Process

Kind = Literal["decentralised", "robust"]
KINDS: tuple[Kind, ...] = ("decentralised", "robust")
#: What of the dynamic decoupling the lag is for: all of it, or its diagonal, which alone needs one.
Lagged = Literal["all", "diagonal"]
#: The course's simulator has no anti-windup.
FORM = PidForm("PI", anti_windup="none")
#: The decoupling is made proper by a lag of this many times the crossover.
FILTER = 10.0


@cache
def decentralised(set_up: SetUp) -> Controller:
    """Return the decentralised PI control, designed in volts.

    Examples
    --------
    >>> round(decentralised(MINIMUM).values["level_1.proportional_gain"], 3)
    1.74
    """
    return design_phase_margin(
        course_model(set_up),
        set_up.pairing,
        form=FORM,
        phase_margin=PHASE_MARGIN,
        crossover=set_up.crossover,
    )


@cache
def robust(set_up: SetUp, lagged: Lagged = "all") -> Controller:
    """Return the Glover-McFarlane controller in volts, with γ = 1.1 γ_min and of full order."""
    model, shaping = course_model(set_up), shaping_of(set_up, lagged)
    order = len(model.states) + len(shaping.system.A)
    return design_glover_mcfarlane(model, set_up.pairing, precompensator=shaping, order=order)


def shaping_of(set_up: SetUp, lagged: Lagged = "all") -> Precompensator:
    """Return what gives the loop of the robust controller its shape."""
    if set_up is MINIMUM:
        return precompensator_of(decentralised(set_up), course_model(set_up))
    return dynamic_decoupling(set_up, lagged)


def dynamic_decoupling(set_up: SetUp, lagged: Lagged = "all") -> Precompensator:
    """Return PI control of both outputs through a dynamic decoupling, as the course has it.

    W = [[w₁₁, 1], [1, w₂₂]] a/(s + a) with w₁₁ = −g₂₂/g₂₁ and w₂₂ = −g₁₁/g₁₂ makes G W
    diagonal, and the lag a = 10 ω_c makes it proper; with a lag of the improper w₁₁ and w₂₂ alone
    it is diagonal at low frequencies. Each PI has the phase margin at the crossover of its own
    element of G W. As det W = det G/(g₁₂ g₂₁), the zero of G in the right half-plane stays.
    """
    model = course_model(set_up)
    times = -1.0 / model.A.diagonal()
    k = model.B  # rates of the levels per volt: γ k/A on the lower tanks
    ratios = np.array([-k[1, 1] / k[3, 0], -k[0, 0] / k[2, 1]])
    # A₄/(A₂ T₄) leads from tank 4 to tank 2: g₂₂/g₂₁ = k₂₂/k₄₁ (1 + s T₄).
    leads = times[[3, 2]]
    lag, s = FILTER * set_up.crossover, 1j * set_up.crossover
    one, cross = np.eye(2), np.eye(2)[::-1]
    W = np.diag(ratios * (1.0 + s * leads)) * lag / (s + lag)
    W = W + cross * (lag / (s + lag) if lagged == "all" else 1.0)
    responses = np.diag(transfer_at(model, np.array([s]))[0] @ W)
    # K and Ti of the PI with the phase margin at the crossover of an element.
    angles = math.pi - PHASE_MARGIN + np.angle(responses)
    gains = np.diag(np.cos(angles) / np.abs(responses))
    rates = gains * set_up.crossover * np.tan(angles)
    # Integrals x_i' = K/Ti e, v = K e + x_i; filters f' = a (v − f).
    zero = np.zeros((2, 2))
    A = np.block([[zero, zero], [lag * one, -lag * one]])
    B = np.vstack([rates, lag * gains])
    # u₁ = w₁₁ f₁ (1 + s T) + f₂ with s f = a (v − f), or + v₂, and u₂ likewise.
    direct = np.diag(ratios * leads * lag)
    through = np.diag(ratios) - direct
    if lagged == "all":
        through = through + cross
    else:
        direct = direct + cross
    C = np.hstack([direct, through])
    period = model.point.process.sampling_period if model.point else math.nan
    system = SampledSystem.by_tustins_rule((A, B, C, direct @ gains), period)
    return Precompensator("PI with dynamic decoupling", system, model.outputs, model.inputs)


def at_the_simulator(
    set_up: SetUp, kind: Kind, process: Process, lagged: Lagged = "all"
) -> Controller:
    """Return a design with the same numbers at the simulator: from rest at zero, unwarned.

    The simulator hands the error to the controller and the output of the controller to the
    pumps, both in the unit of the process, with no operating point, no anti-windup and zeros in
    every state. A gain of 1 V/V becomes 1 %/%, three times as much.
    """
    controller = decentralised(set_up) if kind == "decentralised" else robust(set_up, lagged)
    measured = [process.signal(name) for name in controller.measurements]
    manipulated = [process.signal(name) for name in controller.manipulated]
    if kind == "robust":
        A, B, C, D = precompensator_of(controller, course_model(set_up)).system
        # The outputs at rest, which no error moves, are zero there. The law takes y - r.
        memory = B.any(axis=1)
        A, B, C = A[np.ix_(memory, memory)], -B[memory], C[:, memory]
        matrices = ConditionedMatrices(A, B, np.zeros_like(C.T), C, -D)
        law = conditioned_linear_law(measured, manipulated, matrices)
        values = matrices.values(measured, manipulated)
        for signal in manipulated:
            values |= {path(signal, "bias"): 0.0, path(signal, "fading_time"): 1.0}
    else:
        law = multiloop_pid_law(measured, manipulated, FORM)
        values = dict(controller.values)
    for signal in manipulated:
        values |= {path(signal, "low_limit"): signal.low, path(signal, "high_limit"): signal.high}
    remembered = remembered_parameters(law, values)
    state = {entry.name: 0.0 for entry in law.state if entry.name not in remembered}
    return replace(controller, law=law, values=values, initial_state=state)
