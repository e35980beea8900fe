"""The chain, the printed model (21), and the six designs of section 6 on both."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.polynomial.element_sampling import sampled_transfer
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.smith_predictor import design_smith_predictor
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.profile import Change
from clepsydra.loop.scenario import scenario_of_changes
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.figure import Curve, Panel
from clepsydra.papers.settling_bands import BANDS
from clepsydra.process.reader import load_process
from clepsydra.scores.effort import RESOLUTION, TOTAL_VARIATION, reversals
from clepsydra.scores.step_response import overshoot, settling_time

MINUTE = 60.0  # [s]
#: T0 [min]
PERIOD = PRINTED["section 3.1", "sampling period T0"].value
#: Model (21) in minutes and m³/min: B, A and d.
PRINTED_B, PRINTED_A = PRINTED.numbers("(21)", "b1", "b2"), PRINTED.numbers("(21)", "a1", "a2")
PRINTED_D = int(PRINTED["section 3.1", "delay steps of the smallest J(d)"].value)
#: Equation (8): gain [min/m²], time constant of a tank [min], tanks.
GAIN, TIME_CONSTANT = PRINTED.numbers("(8)", "static gain", "time constant of a tank")
TANKS = int(PRINTED["(8)", "order"].value)
#: Of the inflow after a step, as `StepRun` has it; some designs still swing when a run ends.
FINAL_INFLOW = 1.0 / GAIN
#: The loop is linear and the document names no size: small enough that no tank runs over [m].
_STEP = 0.01
_SAMPLES = 240
#: Gains that only simulate, so wide that no limit is met [m³/s].
_WIDE = 1.0


@dataclass(frozen=True)
class Choice:
    """Penalty, assigned pole and figure of one experiment of section 6."""

    figure: str
    penalty: float
    pole: float

    @property
    def label(self) -> str:
        """As the figures name it."""
        return f"q_u = {self.penalty:g}, γ = {self.pole:g}"

    @property
    def run(self) -> StepRun:
        """What it does on the true chain."""
        return step_run(self.penalty, (self.pole,))


#: Section 6.1 and 6.2.
SIX = tuple(Choice(f"Fig. {n}", *PRINTED.numbers(f"Fig. {n}", "q_u", "γ")) for n in range(7, 13))
POLES, PENALTIES = SIX[:3], SIX[3:]


@dataclass(frozen=True, eq=False)
class StepRun:
    """A unit step of the setpoint on the true chain."""

    minutes: np.ndarray
    level: np.ndarray  # [m/m]
    inflow: np.ndarray  # [m³/min/m]

    @property
    def overshoot(self) -> float:
        """[%]"""
        return overshoot(self.minutes, self.level, 0.0, 1.0)

    @property
    def settling_time(self) -> float:
        """To 2 % [min]."""
        return self.settled(BANDS[0])

    def settled(self, band: float) -> float:
        """Return the time to settle to a band [min]."""
        return settling_time(self.minutes, self.level, 0.0, 1.0, band=band)

    @property
    def total_variation(self) -> float:
        """Of the inflow [m³/min/m]."""
        return TOTAL_VARIATION.along(self.minutes, self.inflow)

    @property
    def largest_inflow(self) -> float:
        """[m³/min/m]"""
        return float(np.max(np.abs(self.inflow)))

    @property
    def swings(self) -> int:
        """How often the inflow turns by more than 2 % of its final value."""
        return turns(self.inflow, 0.02 * FINAL_INFLOW)


def turns(values: np.ndarray, least: float) -> int:
    """Return how often a signal turns back by more than a least amount."""
    return int(reversals(np.arange(len(values)), values, 0.0, least / RESOLUTION))


@cache
def chain() -> Analysis:
    """Return the analysis of the catalogue's process, with the printed gain."""
    return analyse(load_process("eight-tanks:paper"))


@cache
def sampled_chain(gain: float = GAIN, period: float = PERIOD) -> SampledModel:
    """Return equation (9) of (8): the chain sampled with a period [min], in m³/min."""
    below = [float(value) for value in np.poly([-1.0 / TIME_CONSTANT] * TANKS)]
    return sampled_transfer([gain * below[-1]], below, 0, period)


@cache
def printed_model() -> SampledModel:
    """Return model (21) in minutes and m³/min."""
    return SampledModel(tuple(PRINTED_B), tuple(PRINTED_A), PRINTED_D, PERIOD)


@cache
def designed(penalty: float, poles: tuple[float, ...]) -> Controller:
    """Return the document's Smith predictor for model (21), its limits out of reach.

    The penalty is q_u [m²/(m³/min)²]; without poles γ, D is of second order as in (28).
    """
    numerator = tuple(MINUTE * b for b in PRINTED_B)
    model = SampledModel(numerator, tuple(PRINTED_A), PRINTED_D, PERIOD * MINUTE)
    controller = design_smith_predictor(
        chain().model, chain().pairing, penalty=penalty * MINUTE**2, assigned_poles=poles,
        models=[model],
    )  # fmt: skip
    return without_limits(controller)


def without_limits(controller: Controller) -> Controller:
    """Return a controller whose limits are out of reach, since the document has none."""
    limits = {"feed.low_limit": -_WIDE, "feed.high_limit": _WIDE}
    return dataclasses.replace(controller, values=controller.values | limits)


@cache
def step_run(penalty: float, poles: tuple[float, ...]) -> StepRun:
    """Return what the design does on the true chain."""
    return stepped(designed(penalty, poles))


def stepped(controller: Controller) -> StepRun:
    """Return a unit step of the setpoint under a controller, on the true chain."""
    point = chain().operating_point
    level, inflow = point.as_dict()["level_8"], point.as_dict()["feed"]
    step = Change("level_8", level + _STEP, 0.0, 0.0)
    run = Loop(controller, chain().model).run(scenario_of_changes(point, [step], _SAMPLES))
    return StepRun(
        np.arange(_SAMPLES, dtype=float),
        (run.true_measurement("level_8") - level) / _STEP,
        (run.values["feed"] - inflow) * MINUTE / _STEP,
    )


def trends(runs: Mapping[str, StepRun], until: int = _SAMPLES) -> tuple[Panel, Panel]:
    """Return level and inflow of some runs by name, for so many minutes."""
    shown = {name: (run.minutes[:until], run) for name, run in runs.items()}
    level = [Curve(name, time, run.level[:until]) for name, (time, run) in shown.items()]
    inflow = [Curve(name, time, run.inflow[:until], "held") for name, (time, run) in shown.items()]
    return (
        Panel("Level of tank 8", "y [m/m]", level, "time [min]"),
        Panel("Inflow", "u [m³/min/m]", inflow, "time [min]"),
    )
