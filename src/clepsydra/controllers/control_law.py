"""A step law of a control system: what it reads and gives is that of its process signals."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law


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

    Parameters
    ----------
    name : str
        An identifier.
    equations : callable
        Writes one `Sample`.
    measured, controlled, manipulated : sequence of Signal
        The process signals, for sp of each controlled one, pv and good of each measured one, mode,
        manual, tracking, out and status of each manipulated one, and time_step.
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
