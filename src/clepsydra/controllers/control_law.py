"""A step law of a control system, and a law within another one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law


def inner_equations(law: StepLaw, symbols: Symbols) -> Equations:
    """Return what a law computes; the calls of its blocks are calls of the law around it.

    `symbols`: its state, inputs and parameters by name, among others.

    Raises ClepsydraError: the law is Python.
    """
    if law.equations is None:
        raise ClepsydraError(f"{law.name}: a law in Python cannot stand in another one")
    names = [entry.name for entry in (*law.state, *law.inputs, *law.parameters)]
    found = law.equations({name: symbols[name] for name in names})
    following, outputs, between = (
        {name: ca.SX(value) for name, value in group.items()}
        for group in (found.next_state, found.outputs, found.intermediates)
    )
    return Equations(following, outputs, between)


def control_law(
    name: str,
    equations: Callable[[Sample], None],
    *,
    measured: Sequence[Signal],
    controlled: Sequence[Signal],
    manipulated: Sequence[Signal],
    parameters: Sequence[Signal],
    state: Sequence[Signal | DelayRing],
    description: tuple[str, ...] = (),
) -> StepLaw:
    """Write the step law of a control system.

    `name`: an identifier; `equations`: writes one `Sample`; `measured`, `controlled`,
    `manipulated`: the process signals, for sp of each controlled one, pv and good of each measured
    one, mode, manual, tracking, out and status of each manipulated one, and time_step.
    """

    def written(symbols: Symbols) -> Equations:
        sample = Sample(symbols)
        equations(sample)
        return sample.equations()

    return step_law(
        name,
        inputs=[
            *signals.setpoint_inputs(controlled),
            *signals.measurement_inputs(measured),
            *signals.output_inputs(manipulated),
        ],
        parameters=parameters,
        state=state,
        outputs=[result for u in manipulated for result in signals.output_signals(u)],
        equations=written,
        description=description,
    )
