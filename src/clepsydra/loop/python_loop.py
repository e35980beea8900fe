"""The slow path: a law in Python beside a kernel that moves the process sample by sample."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.reference import LawEvaluation
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.scenario import Scenario
from clepsydra.program.step_law import Equations, step_law

if TYPE_CHECKING:
    from clepsydra.loop.loop import Loop


@contextmanager
def naming_sample(sample: int, period: float) -> Iterator[None]:
    """Add to an error of a law in which sample it came about.

    Parameters
    ----------
    sample : int
    period : float
        Between samples [s].

    Examples
    --------
    >>> with naming_sample(30, 2.0):
    ...     raise InputError("law.py, line 7, step", "KeyError: 'gain'", "a number", "correct it")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: law.py, line 7, step, sample 30 at 60 s: got \
"KeyError: 'gain'", expected a number; correct it.
    """
    try:
        yield
    except InputError as error:
        place = f"{error.place}, sample {sample} at {sample * period:g} s"
        raise InputError(place, error.value, error.expected, error.remedy) from None


def python_loop(loop: Loop, scenario: Scenario, substeps: int) -> dict[str, np.ndarray]:
    """Simulate a loop whose law is called from outside of the kernel.

    The process is moved by the same statements as in the compiled loop, so a law that does the
    same arithmetic as expressions gives the same run, bit for bit.

    Parameters
    ----------
    loop : Loop
    scenario : Scenario
    substeps : int
        RK4 steps in a sampling period.

    Returns
    -------
    dict
        Name to trajectory [samples]: what the compiled loop records.

    Raises
    ------
    InputError
        The law fails; the message names the sample and its time.

    Examples
    --------
    A compiled law on the slow path:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.loop import Loop
    >>> plant = cl.load("quadruple-tank")
    >>> loop = Loop(cl.design.simc(plant), plant.linear)
    >>> setpoints = np.repeat([plant.point.measurements[:2] + [1.0, 0.0]], 50, axis=0)
    >>> scenario = Scenario(1.0, setpoints, np.zeros((50, 2)), np.zeros((50, 4)), (), 1)
    >>> slow = python_loop(loop, scenario, loop.substeps)["level_1"]
    >>> bool((slow == loop.run(scenario).values["level_1"]).all())
    True
    """
    process, controller, law = loop.process, loop.controller, loop.controller.law
    given, at_rest, initial = loop.inputs_of(scenario), loop.at_rest(), loop.initial_state()
    by_hand = [f"{u.name}.manual" for u in process.inputs]
    outside = {d.name for d in process.disturbances}
    outside |= {f"{y.name}.noise" for y in process.measurements}
    constant = {
        name: value
        for name, value in at_rest.items()
        if name not in outside and name not in by_hand and not name.startswith("controller.")
    }
    program = closed_loop(process, _NOBODY, substeps=substeps, constant=constant)
    moving = SteppedKernel(
        Kernel(program),
        inputs={name: at_rest[name] for name in by_hand},
        state={k: v for k, v in initial.items() if not k.startswith("controller.")},
    )
    evaluation = LawEvaluation(
        law,
        np.array([controller.values[parameter.name] for parameter in law.parameters]),
        np.array([controller.initial_state[entry.name] for entry in law.state]),
    )
    rows: list[dict[str, float]] = []
    for k in range(scenario.samples):
        now = at_rest | {name: float(column[k]) for name, column in given.items()}
        told = {name: now[name] for name in outside}
        now |= moving.look(told)
        with naming_sample(k, scenario.sampling_period):
            outputs = evaluation.step(loop.law_inputs(now))
        now |= loop.told_by_law(outputs)
        moving.step({f"{u.name}.manual": now[u.name] for u in process.inputs})
        rows.append(now)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


#: Stands for no controller: every input of the process is at its manual value.
_NOBODY = Controller(
    "nobody", "none", "", step_law(
        "nobody", inputs=[], parameters=[], state=[], outputs=[],
        equations=lambda symbols: Equations({}, {}),
    ),
    {}, {}, (), (), (),
)  # fmt: skip
