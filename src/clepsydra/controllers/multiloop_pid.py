"""Multiloop PID: one P, PI, PD or PID controller for each pair of signals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.block import Block
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.program.step_law import StepLaw

Decoupling = Literal["static", "dynamic"]


def multiloop_pid_law(
    loops: int,
    form: PidForm | None = None,
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
    rate_limited: bool = False,
    decoupling: Decoupling | None = None,
) -> StepLaw:
    """Write the step law of PID controllers, loop i from measurement_i to manipulated_i.

    The equations of each form stand in `PidForm`. In automatic, for PI control::

        v  = K (b r − y) + I
        u  = min(high limit, max(low limit, v))
        I⁺ = I + Δt K/Ti e + min(Δt/Tt, 1) (u − v)      back-calculation
        I⁺ = I + Δt K/Ti e  unless it pushes further into saturation      conditional integration
        I⁺ = I + Δt K/Ti e  within the limits of the output      clamping

    The integral I is in the unit of the output and holds the bias.

    Parameters
    ----------
    loops : int
        Number of loops.
    form : PidForm, optional
        PI control in the isa form with back-calculation if omitted.
    measured, manipulated : sequence of Signal, optional
        The process signals of loop 1, 2, …: they lend their units and ranges.
    rate_limited : bool
        Whether the outputs have rate limits.
    decoupling : {"static", "dynamic"}, optional
        Whether each output also answers to the last values of the others: inverted decoupling,
        which heeds their limits and modes, see `structure.feedforward_block`.

    Returns
    -------
    StepLaw
        Inputs setpoint_i, measurement_i, sensor_i, mode_i, manual_i, tracking_i and
        time_step [s]; parameters as in `pid_parameters.pid_parameters`, low_limit_i and
        high_limit_i, with decoupling feedforward_gain_i_j and feedforward_reference_i_j for
        output i from output j, and feedforward_lead_i_j, feedforward_lag_i_j [s] where dynamic;
        outputs manipulated_i, status_i.

    Raises
    ------
    InputError
        There is no loop, or the signals are not one for each loop.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapters 3 and 13.

    Examples
    --------
    One sample at an error of 1 with K = 2, Ti = 10 s, I = 5, inside wide limits:

    >>> law = multiloop_pid_law(1, PidForm(anti_windup="conditional_integration"))
    >>> given = dict(setpoint_1=1, measurement_1=0, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(proportional_gain_1=2, integral_time_1=10, setpoint_weight_1=1,
    ...               low_limit_1=0, high_limit_1=100)
    >>> start = dict(integral_1=5, last_proportional_gain_1=2, last_setpoint_weight_1=1)
    >>> state, outputs, _ = law.function(
    ...     [start.get(signal.name, 0) for signal in law.state],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (7.0, 5.2)
    """
    chosen = form or PidForm()
    measured = signals.wired_signals("measurement", loops, measured, "PID law, measured")
    manipulated = signals.wired_signals("output", loops, manipulated, "PID law, manipulated")
    blocks: list[Block] = []
    for i, (measurement, output) in enumerate(zip(measured, manipulated, strict=True), start=1):
        loop = f"loop {i}"
        direct = i if decoupling is None else None
        blocks.append(PidBlock(loop, i, chosen, measurement, i, output, i, direct))
        if decoupling is not None:
            terms = _decoupling_terms(i, manipulated, decoupling == "dynamic")
            blocks.append(FeedforwardBlock(f"sum {i}", loop, output, terms))
            loop = f"sum {i}"
        blocks.append(OutputBlock(i, output, loop, rate_limited))
    return structure_law(
        f"multiloop_{chosen.actions.lower()}", blocks, controlled=measured, measured=measured
    )


def _decoupling_terms(
    i: int, manipulated: Sequence[Signal], dynamic: bool
) -> tuple[FeedforwardTerm, ...]:
    return tuple(
        FeedforwardTerm(f"{i}_{j}", other, f"last_output_{j}", dynamic)
        for j, other in enumerate(manipulated, start=1)
        if j != i
    )


def family(form: PidForm) -> str:
    """Return what the reader calls this kind of law.

    Examples
    --------
    >>> family(PidForm("PID"))
    'multiloop PID'
    """
    return f"multiloop {form.actions}"
