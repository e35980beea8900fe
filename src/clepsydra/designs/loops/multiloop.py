"""What the designs of multiloop PID controllers share: form checked, controller made."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import permutations
from typing import Literal, TypeVar

from clepsydra.base.errors import InputError
from clepsydra.base.signal import path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.decoupling import Decoupling
from clepsydra.controllers.pid import family, multiloop_pid_law
from clepsydra.controllers.pid_form import PidForm
from clepsydra.designs.applicability import reasons_about
from clepsydra.designs.at_operating_point import controller_at, numbers_at
from clepsydra.designs.decoupling import inverted_decoupler
from clepsydra.designs.loops.loops_together import LoopsTogether
from clepsydra.designs.loops.pairing import PairedLoop, Pairing, paired_loops
from clepsydra.designs.loops.pid_settings import PidSettings, slowed_down, to_parallel, to_series
from clepsydra.designs.loops.words import gain
from clepsydra.designs.slowing_down import SlowedDown
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

T = TypeVar("T")
# Designs that differ in their settings share a law.
_law = lru_cache(maxsize=8)(multiloop_pid_law)
#: The settings of all loops, slowed down together.
Detuned = SlowedDown[Sequence[PidSettings]]
#: Derivative time over the time constant of its filter.
DERIVATIVE_FILTER = 10.0
#: Stands for an integral time that is infinite [s].
_NEVER = 1e9


class MultiloopPid(LoopsTogether[Sequence[PidSettings]]):
    """The PID controllers of one pairing on one model, for any settings.

    `delay` is what sampling delays them by, half a period [s].

    Raises
    ------
    InputError
        The model has no operating point, the form is neither PI nor PID, or the pairing is no
        pairing of the model.
    NotApplicable
        A signal has no finite range, an input does not move its output, or decoupling cannot be
        realised.
    """

    def __init__(
        self,
        model: LinearModel,
        pairing: Pairing | None,
        form: PidForm | None,
        method: str,
        decoupling: Decoupling | None = None,
    ) -> None:
        self.form, self.actions = checked_form(form)
        self.point = operating_point_of(model)
        self.process = self.point.process
        self.delay = self.process.sampling_period / 2.0
        self.loops = paired_loops(model, pairing)
        for loop in self.loops:
            _ = loop.element  # refused where there is none
        law = _law(
            tuple(loop.output for loop in self.loops),
            tuple(loop.input for loop in self.loops),
            self.form,
            decoupling=decoupling,
        )
        by = "" if decoupling is None else f"{decoupling} decoupling"
        terms = {} if decoupling is None else self._decoupling_terms(decoupling)
        blank = controller_at(
            self.point,
            f"{self.actions}, {method}" + (f", {by}" if by else ""),
            family(self.form) + (f" with {by}" if by else ""),
            law,
            numbers_at(self.point, law.parameters, **terms),
            structure=Complexity.ADVANCED_LOOPS if by else Complexity.LOOPS,
            free_inputs=self._remote_setpoints(),
        )
        super().__init__(blank, model, self._settings)

    def each(self, rule: Callable[[PairedLoop], T]) -> list[T]:
        """Return what a rule gives each loop; what it refuses it says of the pair."""
        found = []
        for loop in self.loops:
            with reasons_about(loop.pair):
                found.append(rule(loop))
        return found

    def detuned(self, settings: Sequence[PidSettings]) -> Detuned:
        """Return the settings by K/F and F·Ti with the smallest F that the loops bear together."""
        return self.slowed_down(lambda factor: slowed_down(settings, factor))

    def controller(self, found: Detuned, design: str, notes: Sequence[str]) -> Controller:
        """Return the controller with these settings, at rest at the operating point."""
        words = "; ".join(
            f"{loop.pair}: K = {gain(setting.gain, loop.output, loop.input)}"
            + (f", Ti = {time_text(setting.integral_time)}" if self.form.has_integral else "")
            + (f", Td = {time_text(setting.derivative_time)}" if self.form.has_derivative else "")
            for loop, setting in zip(self.loops, found.design, strict=True)
        )
        closed = [
            f"{loop.pair} with {' and '.join(output for output, _ in loop.others)} closed"
            for loop in self.loops
            if loop.others
        ]
        if closed:
            notes = [*notes, f"Designed: {', '.join(closed)}; alone they answer otherwise at rest."]
        return self.made(found, f"{design}: {words}", notes)

    def _remote_setpoints(self) -> dict[str, float]:
        """Return what a host computer would give, which is not in force at first."""
        at, given = self.point.as_dict(), dict[str, float]()
        for y in (loop.output for loop in self.loops if self.form.remote_setpoint):
            given |= {path(y, "remote_setpoint"): at[y.name], path(y, "setpoint_source"): 0.0}
        return given

    def _decoupling_terms(self, kind: Decoupling) -> dict[str, list[float]]:
        """Return the terms by which inputs answer to the others, which no setting changes."""
        with reasons_about("decoupling"):
            found = inverted_decoupler(self.loops, kind)
        pairs = list(permutations(range(len(self.loops)), 2))
        terms = {
            name: [getattr(found[own][other], name) for own, other in pairs]
            for name in ("gain", "lead", "lag")
        }
        return terms | {"reference": [self.loops[other].resting_input for _, other in pairs]}

    def _settings(self, settings: Sequence[PidSettings]) -> dict[str, float]:
        return {
            name: value
            for loop, setting in zip(self.loops, settings, strict=True)
            for part, value in {**law_settings(setting, self.form), "setpoint_weight": 1.0}.items()
            if (name := path(loop.output, part)) in self.blank.values
        }


def law_settings(settings: PidSettings, form: PidForm) -> dict[str, float]:
    """Return the settings in ISA form as parameters of a loop in any form, names without i.

    The derivative's filter has the time constant Td/10. The tracking time is Ti, or √(Ti Td)
    with derivative action.

    Raises
    ------
    InputError
        The series form is asked for, and Ti is below four times Td.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapter 3, for the tracking
    time.

    Examples
    --------
    >>> law_settings(PidSettings(2.5, 12.5, 2.0), PidForm("PID", "series"))["integral_time"]
    10.0
    """
    gain, integral_time, derivative_time = settings
    tracking = math.sqrt(integral_time * derivative_time) if derivative_time else integral_time
    tracking = min(tracking, _NEVER)
    if form.algorithm == "parallel":
        gain, integral_gain, derivative_gain = to_parallel(settings)
        return {
            "proportional_gain": gain,
            "integral_gain": integral_gain,
            "derivative_gain": derivative_gain,
            # Without derivative action the filter acts on nothing.
            "filter_time": derivative_time / DERIVATIVE_FILTER or 1.0,
            "tracking_time": tracking,
        }
    if form.algorithm == "series":
        gain, integral_time, derivative_time = to_series(settings)
    return {
        "proportional_gain": gain,
        "integral_time": min(integral_time, _NEVER),
        "derivative_time": derivative_time,
        "derivative_filter": DERIVATIVE_FILTER,
        "tracking_time": tracking,
    }


def checked_form(form: PidForm | None) -> tuple[PidForm, Literal["PI", "PID"]]:
    """Return the form asked for, PI where none is, and its actions; refused if it has others."""
    form = PidForm() if form is None else form
    if not isinstance(form, PidForm) or form.actions not in ("PI", "PID"):
        given, expected = getattr(form, "actions", form), "a PidForm with the actions PI or PID"
        raise InputError("form", given, expected, "choose one of the two")
    return form, form.actions


def pi_only(form: PidForm | None) -> PidForm:
    """Return the form asked for, which must have the actions PI."""
    form, actions = checked_form(form)
    if actions != "PI":
        raise InputError("form", actions, "PI: it has no rule for Td", "ask for PI")
    return form
