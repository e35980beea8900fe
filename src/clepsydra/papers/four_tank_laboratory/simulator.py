"""The course's simulator: a controller on the noisy plant, for many seeds at once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.trajectories import Trajectories
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.papers.four_tank_laboratory.controllers import at_the_simulator
from clepsydra.papers.four_tank_laboratory.set_ups import DEVIATIONS, Noise
from clepsydra.process.process import Process


def simulated(
    designed: Controller,
    process: Process,
    samples: int,
    given: Mapping[str, float | np.ndarray],
    parameters: Mapping[str, float] | None = None,
    *,
    drawn: np.random.Generator,
    seeds: int,
    noise: Noise,
    every: int,
) -> Trajectories:
    """Run a controller that was designed in volts from empty tanks, a lane for each seed.

    `given` are inputs at each sample and those that stay, `parameters` stand in the place of the
    plant's, `drawn` gives the noise of both pumps, and one sample in `every` is kept.
    """
    loop = Loop(at_the_simulator(designed, process), linearise(find_equilibrium(process)))
    noises = ["pump_1.noise", "pump_2.noise"]
    columns = drawn.standard_normal((2, 1 if noise == "none" else seeds, samples))
    for name, column in zip(noises, columns, strict=True):
        column *= process.noise[name] * DEVIATIONS[noise]  # in place: they are large
    every_input = {**loop.at_rest(), **given, **dict(zip(noises, columns, strict=True))}
    still = {name: value for name, value in every_input.items() if isinstance(value, float)}
    program = closed_loop(process, loop.controller, substeps=1, constant=still)
    empty = {entry.name: 0.0 for entry in process.motion.contents}
    return Kernel(program, individual=noises).run(
        samples,
        inputs={name: value for name, value in every_input.items() if name not in still},
        state=loop.initial_state() | empty,
        parameters=loop.law_parameters() | dict(parameters or {}),
        every=every,
    )
