"""Variable-structure PID: PID loops whose integral changes its equation while it saturates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True)
class VariableStructureForm(PidForm):
    """A PID form whose anti-windup is the variable structure.

    Raises InputError: there is no integral action that could wind up, or none is kept (velocity
    form).

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
    def parameters(self) -> tuple[str, ...]:
        """Those of a PID loop, and α."""
        return (*super().parameters, "saturation_rate")


def variable_structure_form(form: PidForm) -> VariableStructureForm:
    """Return a form with the variable structure in place of its own anti-windup.

    Examples
    --------
    >>> variable_structure_form(PidForm("PI", "series")).algorithm
    'series'
    """
    return VariableStructureForm(**vars(form) | {"anti_windup": "none"})


def variable_structure_pid_law(
    measured: Sequence[Signal | str],
    manipulated: Sequence[Signal | str],
    form: PidForm | None = None,
) -> StepLaw:
    """Write the step law of variable-structure PID, a loop from each measurement to an output.

    With η the integral of the error and K_I the integral gain the document has

        η′ = −α (u_n − u_s)/K_I  while u_n ≠ u_s and e (u_n − ū) > 0,  else η′ = e,

    with u_n asked for, u_s applied and ū half-way between the limits. Here the integral is
    I = K_I η in the unit of the output, so that nothing is divided by K_I, and e counts with the
    sign of the gain, so that direct action serves too. α Δt is never taken above 1.

    `measured`, `manipulated`: the process signals of each loop: they lend their names, units and
    ranges; `form`: PI control in the isa form if omitted; its own anti-windup does not count.

    Raises InputError: there is no loop, the signals are not one for each loop, or the form has no
    integral.

    References
    ----------
    A. S. Hodel and C. E. Hall, Variable-structure PID control to prevent integrator windup,
    IEEE Transactions on Industrial Electronics 48(2), 2001, 442-451, doi 10.1109/41.915424.

    Examples
    --------
    2 above a limit of 10 with α = 0.25 1/s: half a unit is taken back in a second.

    >>> law = variable_structure_pid_law(["level"], ["pump"])
    >>> given = dict(sp=1, pv=0, good=1, mode=1, time_step=1)
    >>> values = dict(proportional_gain=2, integral_time=10, setpoint_weight=1,
    ...               saturation_rate=0.25, low_limit=0, high_limit=10)
    >>> start = dict(integral=10, last_proportional_gain=2, last_setpoint_weight=1)
    >>> state, outputs, _ = law.function(
    ...     [start.get(signal.part, 0) for signal in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.part] for signal in law.parameters],
    ... )
    >>> float(outputs[0]), float(state[0])
    (10.0, 9.5)
    """
    chosen = variable_structure_form(form or PidForm())
    law = multiloop_pid_law(measured, manipulated, chosen)
    return replace(law, name=f"variable_structure_{chosen.actions.lower()}")


def family(form: PidForm) -> str:
    """Return what the reader calls this kind of law."""
    return f"variable-structure {form.actions}"
