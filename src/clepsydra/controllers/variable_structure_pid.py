"""Variable-structure PID: PID loops whose integral changes its equation while it saturates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class VariableStructureForm(PidForm):
    """A PID form whose anti-windup is the variable structure.

    Raises
    ------
    InputError
        There is no integral action that could wind up, or none is kept (velocity form).

    Examples
    --------
    >>> variable_structure_form(PidForm("PID")).winding
    'variable_structure'
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.has_integral or self.algorithm == "velocity":
            raise InputError(
                "variable-structure PID, form",
                f"{self.actions}, {self.algorithm}",
                "integral action in the isa, series or parallel algorithm",
                "choose PI or PID; a velocity form has no integral that could wind up",
            )

    @property
    def winding(self) -> str:  # type: ignore[override]
        """What the reader is told of its anti-windup."""
        return "variable_structure"

    @property
    def plain(self) -> PidForm:
        """The form without any anti-windup, which has the same settings."""
        return PidForm(**_without_anti_windup(self))


def variable_structure_form(form: PidForm) -> VariableStructureForm:
    """Return a form with the variable structure in place of its own anti-windup.

    Examples
    --------
    >>> variable_structure_form(PidForm("PI", "series")).algorithm
    'series'
    """
    return VariableStructureForm(**_without_anti_windup(form))


def _without_anti_windup(form: PidForm) -> dict[str, Any]:
    chosen = {field.name: getattr(form, field.name) for field in fields(PidForm)}
    return chosen | {"anti_windup": "none"}


@dataclass(frozen=True)
class VariableStructureBlock(PidBlock):
    """A PID loop with saturation_rate_k, the α of its integral.

    Examples
    --------
    >>> form = variable_structure_form(PidForm())
    >>> block = VariableStructureBlock("level", 1, form, Signal("level", "m"), 1,
    ...                                Signal("pump", "V"), 1, 1)
    >>> [signal.name for signal in block.parameters()][-1]
    'saturation_rate_1'
    """

    def own_parameters(self) -> list[Signal]:
        """Those of a PID loop, and α."""
        return [*super().own_parameters(), saturation_rate(self.moved)]


def saturation_rate(moved: Signal) -> Signal:
    """Return saturation_rate [1/s].

    Examples
    --------
    >>> saturation_rate(Signal("pump", "V")).unit
    '1/s'
    """
    return Signal(
        "saturation_rate",
        "1/s",
        low=0.0,
        high=signals.LARGEST_PARAMETER,
        initial=0.1,
        description=f"α: rate at which an excess over the limits of {moved.name} dies away",
    )


def variable_structure_pid_law(
    loops: int,
    form: PidForm | None = None,
    *,
    measured: Sequence[Signal] | None = None,
    manipulated: Sequence[Signal] | None = None,
) -> StepLaw:
    """Write the step law of variable-structure PID, loop i from measurement_i to manipulated_i.

    With η the integral of the error and K_I the integral gain the document has

        η′ = −α (u_n − u_s)/K_I  while u_n ≠ u_s and e (u_n − ū) > 0,  else η′ = e,

    with u_n asked for, u_s applied and ū half-way between the limits. Here the integral is
    I = K_I η in the unit of the output, so that nothing is divided by K_I, and e counts with the
    sign of the gain, so that direct action serves too. α Δt is never taken above 1.

    Parameters
    ----------
    loops : int
    form : PidForm, optional
        PI control in the isa form if omitted; its own anti-windup does not count.
    measured, manipulated : sequence of Signal, optional
        The process signals of loop 1, 2, …: they lend their units and ranges.

    Returns
    -------
    StepLaw
        As that of `multiloop_pid_law`, with saturation_rate_i [1/s].

    Raises
    ------
    InputError
        There is no loop, the signals are not one for each loop, or the form has no integral.

    References
    ----------
    A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent integrator windup,
    IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451, doi 10.1109/41.915424.

    Examples
    --------
    2 above a limit of 10 with α = 0.25 1/s: half a unit is taken back in a second.

    >>> law = variable_structure_pid_law(1)
    >>> given = dict(setpoint_1=1, measurement_1=0, sensor_1=1, mode_1=1, time_step=1)
    >>> values = dict(proportional_gain_1=2, integral_time_1=10, setpoint_weight_1=1,
    ...               saturation_rate_1=0.25, low_limit_1=0, high_limit_1=10)
    >>> start = dict(integral_1=10, last_proportional_gain_1=2, last_setpoint_weight_1=1)
    >>> state, outputs, _ = law.function(
    ...     [start.get(signal.name, 0) for signal in law.state],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (10.0, 9.5)
    """
    chosen = variable_structure_form(form or PidForm())
    measured = signals.wired_signals("measurement", loops, measured, "PID law, measured")
    manipulated = signals.wired_signals("output", loops, manipulated, "PID law, manipulated")
    blocks: list[PidBlock | OutputBlock] = []
    for i, (measurement, output) in enumerate(zip(measured, manipulated, strict=True), start=1):
        blocks.append(VariableStructureBlock(f"loop {i}", i, chosen, measurement, i, output, i, i))
        blocks.append(OutputBlock(i, output, f"loop {i}"))
    return structure_law(
        f"variable_structure_{chosen.actions.lower()}",
        blocks,
        controlled=measured,
        measured=measured,
    )


def family(form: PidForm) -> str:
    """Return what the reader calls this kind of law.

    Examples
    --------
    >>> family(PidForm("PID"))
    'variable-structure PID'
    """
    return f"variable-structure {form.actions}"
