"""A process on its own, many times at once: each lane with parameters and a start of its own."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.engine.kernel import Kernel
from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
from clepsydra.loop.motion_block import MotionBlock, motion_from
from clepsydra.loop.open_loop_plan import plan_simulation
from clepsydra.loop.process_period import process_period
from clepsydra.loop.reported_readings import reporting_at
from clepsydra.process.process import Process


class ProcessBatch:
    """Simulations of the measurements of a process under one set of recorded inputs [SI].

    Its sampling period is that of the record; inputs and disturbances that are not given stay
    nominal. A period that is too long, or that no delay of the process fits, is an InputError.
    """

    def __init__(self, process: Process, given: Mapping[str, np.ndarray]) -> None:
        self.process = process
        self.samples = len(next(iter(given.values())))
        self.outside = (*process.inputs, *process.disturbances)
        self.given = {
            signal.name: np.asarray(given.get(signal.name, np.full(self.samples, signal.initial)))
            for signal in self.outside
        }
        steady = {signal.name: signal.initial for signal in process.state}
        # Twice the steps that the fastest eigenvalue asks for: RK4 errs sixteen times less.
        self.substeps = 2 * plan_simulation(process, duration="1 h", state=steady).substeps
        motion = process.motion
        self.motion = MotionBlock(motion, process.sampling_period, self.substeps)

    def rest(self) -> np.ndarray:
        """Return the state [n] at rest under the first inputs; the initial one without a rest."""
        process = self.process
        first = {name: float(values[0]) for name, values in self.given.items()}
        try:
            point = find_equilibrium(
                process,
                inputs={signal.name: first[signal.name] for signal in process.inputs},
                disturbances={signal.name: first[signal.name] for signal in process.disturbances},
            )
        except (NoEquilibrium, InputError):
            return np.array([signal.initial for signal in process.state])
        return point.state.copy()

    def measured(
        self, parameters: Mapping[str, np.ndarray], start: np.ndarray, samples: int | None = None
    ) -> np.ndarray:
        """Return the measurements [lanes, q, samples], without noise, from a start [n, lanes].

        The parameters are those that differ from the process's own, each [lanes].
        """
        process = self.process
        values = np.tile(process.parameter_values[:, None], (1, start.shape[1]))
        for place, signal in enumerate(process.parameters):
            if signal.name in parameters:
                values[place] = parameters[signal.name]
        first = np.array([given[0] for given in self.given.values()])
        inputs, disturbances = np.split(first, [len(process.inputs)])
        begins = [
            {**motion_from(process.motion, x, inputs, disturbances, p), **self._reporting(x, p)}
            for x, p in zip(start.T, values.T, strict=True)
        ]
        count = self.samples if samples is None else samples
        result = self._kernel.run(
            count,
            inputs={name: values[:count] for name, values in self.given.items()},
            parameters={s.name: values[place] for place, s in enumerate(process.parameters)},
            state={name: np.array([lane[name] for lane in begins]) for name in begins[0]},
            threads=1,
        )
        return np.stack([result.output(s.name) for s in process.measurements], axis=1)

    def _reporting(self, x: np.ndarray, p: np.ndarray) -> dict[str, float]:
        """Return what the sensors have still to tell: as if they had read the same for ever."""
        read = np.array(self.process.measure(x, p)).ravel()
        names = (y.name for y in self.process.measurements)
        return reporting_at(self.process, dict(zip(names, read.tolist(), strict=True)))

    @cached_property
    def _kernel(self) -> Kernel:
        process = self.process
        return Kernel(
            process_period(process, self.motion, (), shown="start", reading=process.measure)
        )
