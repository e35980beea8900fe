"""Nonlinear model predictive control: in every sample the best inputs over a horizon, in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from clepsydra.base.key import Key
from clepsydra.base.pickled_fields import PickledFields
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.python_law import PythonLaw, python_law
from clepsydra.optimal_control.grid import Grid
from clepsydra.optimal_control.load_filter import Estimate, LoadFilter
from clepsydra.optimal_control.receding_horizon import Now, RecedingHorizon
from clepsydra.optimal_control.search import NoCourse

ESTIMATE = Key("estimate", "{x}", "estimated {x}", like="x")
LOAD = Key("load", "{u}", "what is added to {u} without being asked for, as estimated")
_UNSOLVED = "unsolved"
#: How far a load wanders, a share of the authority of its input.
WANDERING_SHARE = 0.3
_COVARIANCE = "covariance"
_DESCRIPTION = (
    "Nonlinear model predictive control, a law in Python: in every sample IPOPT finds the inputs "
    "that leave the least error over the horizon, on the equations of the process, and the first "
    "of them is given out. An extended Kalman filter estimates contents and the load of each "
    "input. Where no plan is found the last one goes on.",
)
#: Plans that are kept: a linear model by differences asks for the same ones many times.
_KEPT = 64


@dataclass(frozen=True, eq=False)
class NonlinearPredictiveStep(PickledFields):
    """One sample: move the estimate on, correct it, and find the best inputs from there.

    Parameters
    ----------
    filter : LoadFilter
        Of the controlled outputs.
    grid : Grid
        Blocks of the plan.
    move_sizes : ndarray [m]
        What moves within a sample are divided by, shares of the ranges.
    move_weight : float
        What their squares weigh [1].
    authorities : ndarray [m]
        How far the inputs may be pushed from rest, shares of the ranges: as unsure they are, and
        loads wander by three tenths of it.
    load_time : float
        Within which they do [s].
    sensors : ndarray [q]
        Standard deviations of the noise of the outputs, over their sizes.
    """

    filter: LoadFilter
    grid: Grid
    move_sizes: np.ndarray
    move_weight: float
    authorities: np.ndarray
    load_time: float
    sensors: np.ndarray

    @cached_property
    def _horizon(self) -> RecedingHorizon:
        return RecedingHorizon(self.filter.model, self.grid, self.move_sizes, self.move_weight)

    @cached_property
    def noise(self) -> np.ndarray:
        """W, of contents and loads in a sample."""
        wander = WANDERING_SHARE * self.authorities
        return self.filter.noise(self.authorities, wander, self.load_time)

    @cached_property
    def _planned(self) -> Any:
        def planned(*given: bytes) -> np.ndarray | None:
            *now, plan = (np.frombuffer(each) for each in given)
            blocks = self.grid.blocks + 1
            try:
                return self._horizon.solve(Now(*now), plan.reshape(-1, blocks))
            except NoCourse:
                return None

        return lru_cache(_KEPT)(planned)

    def __call__(
        self,
        state: Mapping[str, float],
        inputs: Mapping[str, float],
        parameters: Mapping[str, float],
        time_step: float,
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Return the next state and what is asked for, as `python_law` takes it."""
        model = self.filter.model
        outputs, moved = model.plant.outputs, model.moved
        estimate, plan, unsolved = self._remembered(state)
        last = self._shares(inputs, [path(name, "last_output") for name in moved])
        expected = self.filter.following(estimate, last, self.noise, time_step)
        sizes = model.plant.sizes_of_errors
        read = np.array([inputs[path(name, "pv")] for name in outputs]) / sizes
        known = self.filter.corrected(expected, read, self.sensors)
        contents = len(model.rest)
        now = Now(
            known.values[:contents],
            known.values[contents:],
            last,
            self._shares(parameters, [path(name, "low_limit") for name in moved]),
            self._shares(parameters, [path(name, "high_limit") for name in moved]),
            np.array([inputs[path(name, "sp")] for name in outputs]),
        )
        shifted = self._horizon.shifted(plan)
        found = self._planned(*(np.ascontiguousarray(part).tobytes() for part in (*now, shifted)))
        if found is None:
            found, unsolved = shifted, unsolved + 1.0
        asked = self._values(found[:, 0])
        return (
            self._state(known, found, unsolved),
            {path(name, "out"): float(value) for name, value in zip(moved, asked, strict=True)},
        )

    def signals_of_state(self) -> tuple[list[Signal], list[Signal]]:
        """Return what it remembers: estimates, and what does nothing to its outputs near rest."""
        model = self.filter.model
        process, plant = model.plant.process, model.plant
        contents = [process.motion.contents[place] for place in plant.acting]
        inputs = [process.signal(name) for name in model.moved]
        estimated = [ESTIMATE.of(x, x=x) for x in contents] + [LOAD.of(u, u=u) for u in inputs]
        beside = [
            Signal(name, description="how unsure the estimate is", matrix=_COVARIANCE)
            for name in elements(_COVARIANCE, len(estimated) * (len(estimated) + 1) // 2)
        ]
        for u in inputs:
            names = elements(path(u, "plan"), self.grid.blocks + 1)
            beside += [signals.like(u, name, f"{u.name} as planned") for name in names]
        told = "samples in which no plan was found"
        return estimated, [*beside, Signal(_UNSOLVED, low=0.0, kind="integer", description=told)]

    def begin(self, covariance: np.ndarray) -> dict[str, float]:
        """Return the state at rest."""
        rest = self.filter.model.inputs_at_rest
        plan = np.tile(rest[:, None], (1, self.grid.blocks + 1))
        return self._state(Estimate(self.filter.rest, covariance), plan, 0.0)

    def _state(self, known: Estimate, plan: np.ndarray, unsolved: float) -> dict[str, float]:
        model = self.filter.model
        low, high = model.input_ends
        contents = len(model.rest)
        upper = known.covariance[np.triu_indices(len(known.values))]
        planned = low[:, None] + (high - low)[:, None] * plan
        values = [
            *(known.values[:contents] * model.scales),
            *(known.values[contents:] * (high - low)),
            *upper,
            *planned.ravel(),
            unsolved,
        ]
        return {name: float(v) for name, v in zip(self._names, values, strict=True)}

    def _remembered(self, state: Mapping[str, float]) -> tuple[Estimate, np.ndarray, float]:
        """Return estimate, plan and count of a state."""
        model = self.filter.model
        low, high = model.input_ends
        size, blocks = len(self.filter.rest), self.grid.blocks + 1
        *values, unsolved = (state[name] for name in self._names)
        held = np.array(values[:size]) / np.append(model.scales, high - low)
        rows, columns = np.triu_indices(size)
        covariance = np.zeros((size, size))
        covariance[rows, columns] = covariance[columns, rows] = values[size : size + len(rows)]
        planned = np.array(values[size + len(rows) :]).reshape(-1, blocks)
        plan = (planned - low[:, None]) / (high - low)[:, None]
        return Estimate(held, covariance), plan, unsolved

    @cached_property
    def _names(self) -> list[str]:
        estimated, beside = self.signals_of_state()
        return [signal.name for signal in (*estimated, *beside)]

    def _shares(self, values: Mapping[str, float], names: list[str]) -> np.ndarray:
        """Return values of the inputs as shares of their ranges."""
        low, high = self.filter.model.input_ends
        return (np.array([values[name] for name in names]) - low) / (high - low)

    def _values(self, shares: np.ndarray) -> np.ndarray:
        """Return inputs in SI from the first of a plan."""
        low, high = self.filter.model.input_ends
        return low + (high - low) * shares


def nonlinear_mpc_law(step: NonlinearPredictiveStep) -> PythonLaw:
    """Write the step law of nonlinear model predictive control.

    Parameters
    ----------
    step : NonlinearPredictiveStep
    """
    model = step.filter.model
    signal = model.plant.process.signal
    outputs, moved = ([signal(n) for n in names] for names in (model.plant.outputs, model.moved))
    estimated, beside = step.signals_of_state()
    law = python_law(
        "nonlinear_mpc",
        step,
        inputs=[
            *signals.setpoint_inputs(outputs),
            *(signals.PV.of(y, measurement=y) for y in outputs),
        ],
        outputs=[signals.OUT.of(u, output=u) for u in moved],
        parameters=[each for u in moved for each in signals.limit_parameters(u)],
        state=[*estimated, *beside],
    )
    aside = tuple(each.name for each in beside)
    return replace(law, description=_DESCRIPTION, aside=aside, unsolved=_UNSOLVED)
