"""What the designs of multiloop PID controllers share: pairing checked, controller made."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal, NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.multiloop_pid import Decoupling, family, multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import reasons_about
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.decoupling import inverted_decoupler
from clepsydra.designs.loops.control_authority import check_ranges, largest_proportional_gain
from clepsydra.designs.loops.law_settings import law_settings
from clepsydra.designs.loops.loops_together import LoopsTogether
from clepsydra.designs.loops.pairing import Pairing, checked_pairing
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import gain
from clepsydra.designs.models.transfer_element import TransferElement, moving_element
from clepsydra.designs.slowing_down import SlowedDown
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

# Designs that differ in their settings share a law.
_law = lru_cache(maxsize=8)(multiloop_pid_law)
#: The settings of all loops, slowed down together.
Detuned = SlowedDown[Sequence[PidSettings]]


class PairedLoop(NamedTuple):
    """One pair: measurement, input, the element between them, and the input at rest.

    Examples
    --------
    >>> element = TransferElement(1.0, (-1.0,), (), 0)
    >>> loop = PairedLoop(Signal("level", "V", low=0.0, high=10.0),
    ...                   Signal("pump", "V", low=0.0, high=10.0), element, 3.0)
    >>> loop.pair, loop.largest_gain
    ('level by pump', 3.0)
    """

    output: Signal
    input: Signal
    element: TransferElement
    resting_input: float

    @property
    def pair(self) -> str:
        """The pair as the reader sees it."""
        return f"{self.output.name} by {self.input.name}"

    @property
    def largest_gain(self) -> float:
        """The largest proportional gain that the room of the input allows."""
        return largest_proportional_gain(self.output, self.input, self.resting_input)


class MultiloopPid(LoopsTogether[Sequence[PidSettings]]):
    """The PID controllers of one pairing on one model, for any settings.

    Parameters
    ----------
    pairing : sequence of (output, input), mapping, or None
        The one that the relative gains suggest for None.
    method : str
        Of the design, for names and messages.
    decoupling : {"static", "dynamic"}, optional
        Whether the law decouples the loops (`designs.decoupling`); each setting is then that of
        its own element alone.

    Raises
    ------
    InputError
        The model has no operating point, or the pairing is empty, names an unknown signal or one
        signal twice.
    NotApplicable
        A signal has no range, or one beyond what a controller takes, an input does not move
        its output, dead times have no place in a transfer function or a sampled loop, or there
        is no decoupler.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> loops = MultiloopPid(analysis.model, analysis.pairing, PidForm("PID"), "by hand")
    >>> [(loop.pair, loop.resting_input) for loop in loops.loops]
    [('level_1 by pump_1', 3.0), ('level_2 by pump_2', 3.0)]
    """

    def __init__(
        self,
        model: LinearModel,
        pairing: Pairing | None,
        form: PidForm,
        method: str,
        decoupling: Decoupling | None = None,
    ) -> None:
        self.method, self.form, self.decoupling = method, form, decoupling
        self.point = operating_point_of(model)
        self.process = self.point.process
        outputs, inputs = checked_pairing(pairing, model)
        check_ranges(self.process, outputs, inputs)
        at = self.point.as_dict()
        self.loops: list[PairedLoop] = []
        for output, input_name in zip(outputs, inputs, strict=True):
            found = moving_element(model, output, input_name)
            signals = self.process.signal(output), self.process.signal(input_name)
            self.loops.append(PairedLoop(*signals, found, at[input_name]))
        super().__init__(self._blank(model), model, self._settings)

    def controller(self, found: Detuned, design: str, notes: Sequence[str]) -> Controller:
        """Return the controller with these settings, at rest at the operating point.

        The setpoint weight is 1 and the limits are the ranges of the inputs.

        Parameters
        ----------
        design : str
            How the settings were found; their values and the peak are added.

        Raises
        ------
        NotApplicable
            A setting is outside of what a controller takes.
        """
        return self.made(found, f"{design}: {self._in_words(found.design)}", notes)

    def _blank(self, model: LinearModel) -> Controller:
        law = _law(
            tuple(loop.output for loop in self.loops),
            tuple(loop.input for loop in self.loops),
            self.form,
            decoupling=self.decoupling,
        )
        return controller_at(
            self.point,
            f"{self.form.actions}, {self.method}" + self._decoupled(", "),
            family(self.form) + self._decoupled(" with "),
            law,
            numbers_at(self.point, law.parameters) | self._fixed_values(model),
            structure=Complexity.ADVANCED_LOOPS if self.decoupling else Complexity.LOOPS,
            free_inputs=self._remote_setpoints(),
        )

    def _remote_setpoints(self) -> dict[str, float]:
        """Return what a host computer would give, which is not in force at first."""
        if not self.form.remote_setpoint:
            return {}
        at = self.point.as_dict()
        given: dict[str, float] = {}
        for y in (loop.output for loop in self.loops):
            given |= {path(y, "remote_setpoint"): at[y.name], path(y, "setpoint_source"): 0.0}
        return given

    def _decoupled(self, joined: str) -> str:
        return "" if self.decoupling is None else f"{joined}{self.decoupling} decoupling"

    def _fixed_values(self, model: LinearModel) -> dict[str, float]:
        """Return decoupling terms, which no setting of a loop changes."""
        values: dict[str, float] = {}
        if self.decoupling is None:
            return values
        pairs = [(loop.output.name, loop.input.name) for loop in self.loops]
        with reasons_about("decoupling"):
            found = inverted_decoupler(model, pairs, kind=self.decoupling)
        for i, loop in enumerate(self.loops):
            for j, other in enumerate(self.loops):
                if i == j:
                    continue
                owner = path(path(loop.input, "feedforward"), other.input.name)
                values[path(owner, "gain")] = float(found.gain[i, j])
                values[path(owner, "reference")] = other.resting_input
                if self.decoupling == "dynamic":
                    values[path(owner, "lead")] = float(found.lead[i, j])
                    values[path(owner, "lag")] = float(found.lag[i, j])
        return values

    def _settings(self, settings: Sequence[PidSettings]) -> dict[str, float]:
        values: dict[str, float] = {}
        for loop, setting in zip(self.loops, settings, strict=True):
            own = law_settings(setting, self.form) | {"setpoint_weight": 1.0}
            values |= {path(loop.output, name): value for name, value in own.items()}
        return {name: value for name, value in values.items() if name in self.blank.values}

    def _in_words(self, settings: Sequence[PidSettings]) -> str:
        return "; ".join(
            f"{loop.pair}: K = {gain(setting.gain, loop.output, loop.input)}"
            + (f", Ti = {time_text(setting.integral_time)}" if self.form.has_integral else "")
            + (f", Td = {time_text(setting.derivative_time)}" if self.form.has_derivative else "")
            for loop, setting in zip(self.loops, settings, strict=True)
        )


def checked_form(form: PidForm | None) -> tuple[PidForm, Literal["PI", "PID"]]:
    """Return the form asked for, PI where none is, and its actions.

    Raises
    ------
    InputError
        It is no form, or has other actions than PI and PID.

    Examples
    --------
    >>> checked_form(None)[1], checked_form(PidForm("PID"))[1]
    ('PI', 'PID')
    """
    form = PidForm() if form is None else form
    if not isinstance(form, PidForm) or form.actions not in ("PI", "PID"):
        raise InputError(
            "form",
            getattr(form, "actions", form),
            "a PidForm with the actions PI or PID",
            "choose one of the two",
        )
    return form, form.actions


def pi_only(form: PidForm | None) -> PidForm:
    """Return the form asked for, which must have the actions PI.

    Raises
    ------
    InputError

    Examples
    --------
    >>> pi_only(None).actions
    'PI'
    """
    form, actions = checked_form(form)
    if actions != "PI":
        raise InputError("form", actions, "PI: it has no rule for Td", "ask for PI")
    return form
