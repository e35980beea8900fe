"""Which PID controller is meant: its actions, its algorithm and its options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from clepsydra.base.arguments import check_choice
from clepsydra.base.errors import InputError
from clepsydra.base.quantity import declared
from clepsydra.controllers.blocks.anti_windup import IN_WORDS, AntiWindup
from clepsydra.process.declared import choice, flag, part

Actions = Literal["P", "PI", "PD", "PID"]
Algorithm = Literal["isa", "series", "parallel", "velocity"]
DerivativeOn = Literal["measurement", "error"]
ErrorShape = Literal["linear", "gap", "squared"]

_DERIVATIVE = ("derivative_time", "derivative_filter", "derivative_gain", "filter_time")
#: Parameters of the shapes of the error.
_SHAPES = {
    "linear": ("setpoint_weight",),
    "gap": ("gap", "gap_gain"),
    "squared": ("squared_error_scale",),
}


@dataclass(frozen=True)
class PidForm:
    """The form of a PID controller.

    With error e = r − y, gain K, integral time Ti, derivative time Td, setpoint weight b, and
    D(x) the filtered derivative of x with the filter time Td/N:

    - isa (standard, non-interacting): u = K (b r − y) + K/Ti ∫ e dt − K Td D(y) + bias
    - series (interacting): u = K (b r − y') + K/Ti ∫ (r − y') dt with y' = y + Td D(y)
    - parallel: u = Kp (b r − y) + Ki ∫ e dt − Kd D(y), each action with its own gain
    - velocity: the isa form as increments of what was applied in the last sample; it has no
      integral that could wind up

    Parameters
    ----------
    actions : {"PI", "P", "PD", "PID"}
        Without I the integral is a bias, which only a change of mode or of gain moves.
    derivative_on : {"measurement", "error"}
        What is differentiated; the error kicks at a setpoint step.
    error : {"linear", "gap", "squared"}
        How the error acts: gap action multiplies it by a gap gain within the gap; squared
        action makes the gain proportional to |e|. With either, r − y as a whole is shaped, and
        there is no setpoint weight.
    anti_windup : {"back_calculation", "conditional_integration", "clamping", "none"}
        Of the forms with an integral.
    setpoint_ramp : bool
        Whether the setpoint moves no faster than a setpoint_ramp; it starts at the measurement
        when the loop goes to automatic.
    remote_setpoint : bool
        Whether a second setpoint may be chosen, from a host computer or another controller.

    Raises InputError: A name is unknown, or the options contradict each other.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapters 3 and 13.

    Examples
    --------
    >>> PidForm("PID").has_integral, PidForm("PD").has_integral, PidForm("PI").has_derivative
    (True, False, False)
    """

    actions: Actions = choice(get_args(Actions), "PI", words="what it answers to the error with")
    algorithm: Algorithm = choice(get_args(Algorithm), words="how its actions are joined")
    derivative_on: DerivativeOn = choice(get_args(DerivativeOn), words="what is differentiated")
    error: ErrorShape = choice(get_args(ErrorShape), words="how the error acts")
    anti_windup: AntiWindup = choice(
        get_args(AntiWindup), words="what integrals do while an output is at a limit"
    )
    setpoint_ramp: bool = part(lambda table, key, known: table.has(key), default=False)
    remote_setpoint: bool = flag(
        default=False, words="whether a host computer may give the setpoint"
    )

    def __post_init__(self) -> None:
        for name, each in declared(PidForm).items():
            value, known = getattr(self, name), each.schema.get("enum")
            if known is not None:
                check_choice(f"PID form, {name}", value, known)
        if self.algorithm == "velocity" and not self.has_integral:
            raise InputError(
                "PID form, actions", self.actions, "PI or PID: without integral action nothing "
                "brings the increments of a velocity form back to the setpoint",
                "choose another algorithm, or add integral action",
            )  # fmt: skip
        if self.error != "linear" and self.algorithm in ("series", "velocity"):
            raise InputError(
                "PID form, error", self.error, "linear error",
                "choose the isa or parallel algorithm for gap or squared action",
            )  # fmt: skip

    @property
    def has_integral(self) -> bool:
        """Whether there is integral action."""
        return "I" in self.actions

    @property
    def has_derivative(self) -> bool:
        """Whether there is derivative action."""
        return "D" in self.actions

    @property
    def winding(self) -> AntiWindup:
        """The anti-windup of the integral; without integral action nothing winds up."""
        return self.anti_windup if self.has_integral else "none"

    @property
    def tracks_back(self) -> bool:
        """Whether there is a tracking time."""
        return self.algorithm != "velocity" and self.winding == "back_calculation"

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of its parameters, which `pid_keys.PARAMETERS` declares."""
        integral, derivative = ("integral_time",), ("derivative_time", "derivative_filter")
        if self.algorithm == "parallel":
            integral, derivative = ("integral_gain",), ("derivative_gain", "filter_time")
        return (
            "proportional_gain",
            *(integral if self.has_integral else ()),
            *(derivative if self.has_derivative else ()),
            *_SHAPES[self.error],
            *(("setpoint_ramp",) if self.setpoint_ramp else ()),
            *(("tracking_time",) if self.tracks_back else ()),
        )

    @property
    def remembered(self) -> tuple[str, ...]:
        """Those whose last value counts where they change, so that nothing jumps.

        The velocity form has no integral that takes a change up: there it is the filter's alone.
        """
        counted: tuple[str, ...] = _DERIVATIVE
        if self.algorithm != "velocity":
            counted = ("proportional_gain", *_DERIVATIVE, *_SHAPES[self.error])
        return tuple(name for name in self.parameters if name in counted)

    @property
    def words(self) -> str:
        """What the reader is told of it, in a line."""
        winds = self.has_integral and self.algorithm != "velocity"
        end = f"; {IN_WORDS[self.winding]}" if winds and self.winding != "none" else ""
        return f"{self.actions} control, {self.algorithm} form{end}"

    @property
    def block(self) -> str:
        """The name of its block: pi, pid_series, pi_conditional_integration.

        Examples
        --------
        >>> PidForm().block, PidForm("PID", "parallel", setpoint_ramp=True).block
        ('pi', 'pid_parallel_ramp')
        """
        words = [self.actions.lower()]
        if self.algorithm != "isa":
            words.append(self.algorithm)
        if self.has_derivative and self.derivative_on == "error":
            words.append("on_error")
        if self.error != "linear":
            words.append(self.error)
        if self.has_integral and self.algorithm != "velocity":
            words += {"back_calculation": [], "none": ["winding"]}.get(self.winding, [self.winding])
        if self.setpoint_ramp:
            words.append("ramp")
        if self.remote_setpoint:
            words.append("remote")
        return "_".join(words)
