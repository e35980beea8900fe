"""The rig of the document, its controllers, and runs that fill it from empty."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.virtual_input import AlphaOn, VirtualAntiWindup
from clepsydra.designs.feedback_linearisation import feedback_linearisation_controller
from clepsydra.designs.loops.multiloop import MultiloopPid
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.variable_structure_pid import with_variable_structure
from clepsydra.designs.virtual_settings import VirtualSettings
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.relative_degree import relative_degree
from clepsydra.loop.law_begin import empty_and_cold
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_kernel import loop_kernel
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.settling_bands import BANDS
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.scores.step_response import overshoots, rise_times, settling_times

#: Levels that the document's figures go to [m], and what the sensors read there per metre [V/m].
TARGET = (0.124, 0.127)
VOLTS_PER_METRE = 50.0
#: Johansson's PI controllers, in volts per volt.
SETTINGS = (PidSettings(3.0, 30.0), PidSettings(2.7, 40.0))
#: The same in words.
IN_WORDS = "K = 3.0 and 2.7, Ti = 30 and 40 s"
#: The document's α; in volts it acts on a level in centimetres, so that here it counts k_c.
ALPHA = PRINTED["section 5", "α"].value
DURATION = 600.0
#: Sampling period of the controllers [s].
SAMPLED = 0.05

WAYS = {
    "none": "output limited only",
    "clamping": "clamping",
    "conditional_integration": "conditional integration",
    "back_calculation": "back-calculation",
    "variable_structure": "variable structure, α = 0.1",
}


@cache
def plant(variant: str = "minimum-phase") -> Process:
    """Return P− or P+."""
    return load_process(Path(__file__).with_name("four-tanks.toml"), variant)


@cache
def at_target(levels: tuple[float, float] = TARGET) -> Analysis:
    """Return P− at rest at two lower levels [m]."""
    wanted = {f"level_{j}": VOLTS_PER_METRE * level for j, level in enumerate(levels, start=1)}
    return analyse(plant(), outputs=wanted)


@cache
def in_volts(way: str, alpha: float = ALPHA, derivative: float = 0.0) -> Controller:
    """Return Johansson's PI controllers in volts, with one of the `WAYS` against windup.

    With a derivative time, a share of Ti, they act on the filtered derivative of the level too.
    """
    analysis = at_target()
    plain = "none" if way == "variable_structure" else way
    form = PidForm("PID" if derivative else "PI", anti_windup=plain)  # type: ignore[arg-type]
    together = MultiloopPid(analysis.model, analysis.pairing, form, "Johansson")
    settings = [each._replace(derivative_time=derivative * each.integral_time) for each in SETTINGS]
    found = together.as_given(settings, "his settings")
    controller = together.controller(found, "As Johansson", ())
    if way != "variable_structure":
        return controller
    return with_variable_structure(controller, form, [alpha, alpha], analysis.model)


@cache
def in_nu(
    way: VirtualAntiWindup, alpha: float = ALPHA, alpha_on: AlphaOn = "virtual"
) -> Controller:
    """Return the linearised process under PI controllers of ν, M = 0 and P = I.

    The PI controllers are Johansson's, so that near the target a volt of error moves the pumps
    as in volts: Kp = E K. α is in 1/s, or with ``alpha_on="input"`` in cm/s² per volt.
    """
    model = at_target().model
    linearised = relative_degree(model)
    rates = [alpha] * 2
    if way == "back_calculation":
        rates = [1.0 / each.integral_time for each in SETTINGS]
    if alpha_on == "input":
        rates = [alpha * VOLTS_PER_METRE / 100.0] * 2
    return feedback_linearisation_controller(
        model, linearised, virtual_settings(), anti_windup=way, rates=rates, alpha_on=alpha_on
    )


@cache
def virtual_settings() -> tuple[VirtualSettings, ...]:
    """Return Johansson's PI controllers times E, for ν.

    Examples
    --------
    E is γ k k_c / A = 0.7 · 3.33 · 0.5 / 28 1/s for the first pump, and K = 3 V/V:

    >>> round(virtual_settings()[0].gain, 6)
    0.124875
    """
    effects = map(float, np.diag(relative_degree(at_target().model).at_point))
    return tuple(
        VirtualSettings(effect * each.gain, effect * each.gain / each.integral_time)
        for effect, each in zip(effects, SETTINGS, strict=True)
    )


@dataclasses.dataclass(frozen=True, eq=False)
class Filling:
    """Runs from empty to a target, one lane each."""

    time: np.ndarray  # [samples] [s]
    values: dict[str, np.ndarray]  # levels and voltages [lanes, samples], SI
    spilt: np.ndarray  # what ran over the rim of each tank [lanes, 4] [cm³]
    target: tuple[float, float]  # [m]
    limits: np.ndarray  # of both pumps, for each lane [V]

    def level(self, tank: int) -> np.ndarray:
        """Return a level [cm] of each lane."""
        return 100.0 * self.values[f"tank_{tank}.level"]

    def voltage(self, pump: int) -> np.ndarray:
        """Return a voltage [V] of each lane."""
        return self.values[f"pump_{pump}"]

    def overshoot(self, tank: int) -> np.ndarray:
        """Return the overshoot of a lower level [%] in each lane."""
        return self._scored(overshoots, tank)

    def rise(self, tank: int) -> np.ndarray:
        """Return the time of a lower level from 10 % to 90 % [s] in each lane."""
        return self._scored(rise_times, tank)

    def settling(self, tank: int, band: float = BANDS[0]) -> np.ndarray:
        """Return the settling time of a lower level to a band [s] in each lane."""
        return self._scored(partial(settling_times, band=band), tank)

    def _scored(self, score: Callable[..., np.ndarray], tank: int) -> np.ndarray:
        return score(self.time, self.level(tank), 0.0, 100.0 * self.target[tank - 1])

    def saturated(self, pump: int) -> np.ndarray:
        """Return how long a pump stands at one of its limits [s] in each lane."""
        voltage = self.voltage(pump)
        return self._summed((voltage >= self.limits[:, None]) | (voltage <= 0.0))

    def pumped(self) -> np.ndarray:
        """Return the volume that both pumps lift [l] in each lane."""
        gains = {pump: plant().signal(f"pump_{pump}.gain").initial for pump in (1, 2)}
        return self._summed(*(1e3 * k * self.voltage(pump) for pump, k in gains.items()))

    def electric(self) -> np.ndarray:
        """Return what the motors take, in proportion to the voltage squared [V² s], in each."""
        return self._summed(*(self.voltage(pump) ** 2 for pump in (1, 2)))

    def _summed(self, *rates: np.ndarray) -> np.ndarray:
        return np.sum(rates, axis=(0, 2)) * (self.time[1] - self.time[0])


def _began(controller: Controller) -> dict[str, float]:
    """Return the states of a law that stood in automatic with its pumps at zero."""
    stood = {f"pump_{i}.last_output": 0.0 for i in (1, 2)}
    stood |= {f"level_{j}.was_in_force": 1.0 for j in (1, 2)}
    return {name: value for name, value in stood.items() if name in controller.initial_state}


def fill(
    controller: Controller,
    limits: float | np.ndarray = 10.0,
    target: tuple[float, float] = TARGET,
    parameters: Mapping[str, np.ndarray] | None = None,
    start: Mapping[str, np.ndarray] | None = None,
) -> Filling:
    """Run from empty tanks and standing pumps to a target, lower levels [m], below limits [V].

    The controller starts cold. `parameters` are of the process, or of the law behind
    "controller.", and `start` its states; each may be one number or one a lane.
    """
    loop = Loop(controller, at_target().model)
    setpoints = {f"level_{j}.setpoint": VOLTS_PER_METRE * h for j, h in enumerate(target, start=1)}
    kernel = loop_kernel(loop.process, controller, loop.at_rest() | setpoints, substeps=1)
    began = empty_and_cold(loop, _began(controller))
    state: dict[str, float | np.ndarray] = {**began, **(start or {})}
    given: dict[str, float | np.ndarray] = dict(loop.law_parameters())
    given |= {f"controller.pump_{i}.high_limit": limits for i in (1, 2)}
    given |= dict(parameters or {})
    samples = round(DURATION / loop.process.sampling_period)
    run = kernel.run(samples, state=state, parameters=given)
    tanks = range(1, 5)
    # Every sample of the controllers, so that the times at a limit are counted as they run.
    kept = [*(f"tank_{j}.level" for j in tanks), "pump_1", "pump_2"]
    values = {name: run.output(name) for name in kept}
    outputs = [signal.name for signal in run.program.outputs]
    at_end = np.array([run.record_of(lane)[-1] for lane in range(run.scenarios)])
    spilt = 1e6 * at_end[:, [outputs.index(f"tank_{j}.spilt") for j in tanks]]
    time = np.arange(samples) * loop.process.sampling_period
    return Filling(time, values, spilt, target, np.broadcast_to(limits, len(spilt)))
