"""The law of PI and PID loops: one P, PI, PD or PID controller for each pair of signals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.decoupling import Decoupling
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.block import Block
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.program.step_law import StepLaw


def multiloop_pid_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    form: PidForm | None = None,
    *,
    rate_limited: bool = False,
    decoupling: Decoupling | None = None,
) -> StepLaw:
    """Write the step law of PID controllers, one from each measurement to an output.

    The equations of each form stand in `PidForm`. In automatic, for PI control::

        v  = K (b r − y) + I
        u  = min(high limit, max(low limit, v))
        I⁺ = I + Δt K/Ti e + min(Δt/Tt, 1) (u − v)      back-calculation
        I⁺ = I + Δt K/Ti e  unless it pushes further into saturation      conditional integration
        I⁺ = I + Δt K/Ti e  within the limits of the output      clamping

    The integral I is in the unit of the output and holds the bias.

    `measured`, `manipulated`: the process signals of each loop: they lend their names, units and
    ranges; `form`: PI control in the isa form with back-calculation if omitted; `rate_limited`:
    whether the outputs have rate limits; `decoupling`: whether each output also answers to the last
    values of the others: inverted decoupling, which heeds their limits and modes, see
    `structure.feedforward_block`.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapters 3 and 13.

    Examples
    --------
    One sample at an error of 1 with K = 2, Ti = 10 s, I = 5, inside wide limits:

    >>> law = multiloop_pid_law(
    ...     ["level"], ["pump"], PidForm(anti_windup="conditional_integration")
    ... )
    >>> given = dict(sp=1, pv=0, good=1, mode=1, time_step=1)
    >>> values = dict(proportional_gain=2, integral_time=10, setpoint_weight=1,
    ...               low_limit=0, high_limit=100)
    >>> start = dict(integral=5, last_proportional_gain=2, last_setpoint_weight=1)
    >>> state, outputs, _ = law.function(
    ...     [start.get(signal.part, 0) for signal in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.part] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (7.0, 5.2)
    """
    pairs = tuple(signals.paired(measured, manipulated))
    return _joined(pairs, form or PidForm(), rate_limited, decoupling)


@lru_cache(maxsize=64)
def _joined(
    pairs: tuple[tuple[Signal, Signal], ...],
    form: PidForm,
    rate_limited: bool,
    decoupling: Decoupling | None,
) -> StepLaw:
    """Return the law of pairs; whoever tunes asks for one law many times."""
    outputs = [output for _, output in pairs]
    blocks: list[Block] = []
    for measurement, output in pairs:
        loop = PidBlock.of(measurement, form, output, direct=decoupling is None)
        blocks.append(loop)
        source = loop.name
        if decoupling is not None:
            terms = (
                FeedforwardTerm(
                    path(path(output, "feedforward"), other.name),
                    output,
                    other,
                    measured=False,
                    dynamic=decoupling == "dynamic",
                )
                for other in outputs
                if other != output
            )
            blocks.append(
                FeedforwardBlock(f"{output.name} decoupled", source, output, tuple(terms))
            )
            source = blocks[-1].name
        blocks.append(OutputBlock(output, source, rate_limited))
    followed = {measurement.name: measurement for measurement, _ in pairs}
    return structure_law(
        f"multiloop_{form.actions.lower()}",
        blocks,
        setpoints=followed,
        measured=list(followed.values()),
    )


def family(form: PidForm) -> str:
    """Return what the reader calls this kind of law."""
    return f"multiloop {form.actions}"
