"""A loop's tuning as the parameters of a vendor's block, and what they mean after rounding."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.controllers.pid_form import DerivativeOn
from clepsydra.deploy.vendor_tuning.block_units import BlockUnits, Setting
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid, to_series
from clepsydra.deploy.vendor_tuning.printed_gain import printed_number
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.deploy.vendor_tuning.vendor_block import (
    DERIVATIVE_KINDS,
    INTEGRAL_KINDS,
    LIMIT_KINDS,
    Form,
    Parameter,
    VendorBlock,
)


class Applied(NamedTuple):
    """What the printed numbers of a block amount to; those of the parallel form in ISA form."""

    form: Form
    settings: FilteredPid
    derivative_on: DerivativeOn


@dataclass(frozen=True)
class Filled:
    """A block filled in for a loop.

    Parameters
    ----------
    settings : tuple of Setting
    choices : tuple of (str, str)
        Switch to what it is set to.
    differs : tuple of str
        What the block cannot do as the controller does it.
    notes : tuple of str
        What else the engineer must know.
    numbers : Applied
        What the printed numbers mean where the block could do all that the controller does.
    applied : Applied
        What they mean in the block as it is.
    """

    settings: tuple[Setting, ...]
    choices: tuple[tuple[str, str], ...]
    differs: tuple[str, ...]
    notes: tuple[str, ...]
    numbers: Applied
    applied: Applied


def filled(block: VendorBlock, tuning: StandardTuning) -> Filled:
    """Fill in a vendor's block for a loop.

    Raises
    ------
    InputError
        The loop has no such form, a signal has no range that percent are of, the documents at
        hand do not say how the block differentiates, or a number is below the block's step.

    Examples
    --------
    >>> from clepsydra import PidForm, Signal
    >>> from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK
    >>> volts = Signal("level", "V", low=0.0, high=10.0)
    >>> tuning = StandardTuning("k", volts, volts, PidForm(), FilteredPid(-3.0, 30.0), True)
    >>> found = filled(EVERY_BLOCK[2], tuning)  # Rockwell PIDE, dependent gains
    >>> [setting.words for setting in found.settings], found.choices[0]
    (['KC = 3 %/%', 'TI = 0.5 min'], ('control action', 'E = PV − SP'))
    """
    return _Filling(block, tuning).done()


class _Filling:
    def __init__(self, block: VendorBlock, tuning: StandardTuning) -> None:
        self.block, self.tuning = block, tuning
        self.units = BlockUnits(block, tuning)
        self.place = f"{tuning.title}, {block.title}"
        self.differs: list[str] = []
        self.notes: list[str] = []

    def done(self) -> Filled:
        block, own_on = self.block, self.tuning.form.derivative_on
        self._check()
        derivative_on = self._derivative_on()
        wanted = self._in_form(own_on)
        target = self._had(self._in_form(derivative_on))
        settings = tuple(
            self._setting(parameter, target, derivative_on)
            for parameter in block.parameters
            if self._given(parameter)
        )
        self._say_the_rest()
        meant = self.units.meant(settings, target)
        # The printed numbers with the filter and weight of the controller again.
        undone = {
            name: getattr(wanted, name)
            for name in ("filter_time", "setpoint_weight")
            if getattr(target, name) != getattr(wanted, name)
        }
        return Filled(
            settings,
            self._choices(target, derivative_on),
            tuple(self.differs),
            tuple(self.notes),
            Applied(block.form, meant._replace(**undone), own_on),
            Applied(block.form, meant, derivative_on),
        )

    def _check(self) -> None:
        tuning, block = self.tuning, self.block
        if block.gain_in == "percent":
            for signal in (tuning.measurement, tuning.moved):
                if not signal.has_range:
                    raise InputError(
                        self.place, f"{signal.name} without a range",
                        "finite ranges, for the gain of this block is in percent of them",
                        "give the signal a range, or take a block whose gain has units",
                    )  # fmt: skip
        if tuning.has_derivative and not block.derivative_on:
            raise InputError(
                self.place, "derivative action",
                "a loop without it: no document at hand says how this block differentiates",
                "take another block, or tune the loop as PI",
            )  # fmt: skip

    def _derivative_on(self) -> DerivativeOn:
        wanted, had = self.tuning.form.derivative_on, self.block.derivative_on
        if not self.tuning.has_derivative or wanted in had:
            return wanted
        kick = ": setpoint steps kick" if had[0] == "error" else ""
        self.differs.append(f"differentiates the {had[0]}, the controller the {wanted}{kick}")
        return had[0]

    def _in_form(self, derivative_on: DerivativeOn) -> FilteredPid:
        """Return the controller's numbers in the block's form."""
        numbers = self.tuning.settings
        if self.block.form == "series":
            return to_series(numbers, derivative_on, self.place)
        return numbers

    def _had(self, numbers: FilteredPid) -> FilteredPid:
        """Return the numbers with the filter and the setpoint weight that the block can have."""
        if self.tuning.has_derivative:
            numbers = numbers._replace(filter_time=self._filter_time(numbers))
        return numbers._replace(setpoint_weight=self._weight(numbers.setpoint_weight))

    def _filter_time(self, numbers: FilteredPid) -> float:
        kind = self.block.derivative_filter
        own = numbers.filter_time
        if isinstance(kind, float):
            theirs = numbers.derivative_time / kind
            if not math.isclose(theirs, own, rel_tol=1e-9):
                self.differs.append(
                    f"filters its derivative with Td/{kind:g} = {theirs:.4g} s, the controller "
                    f"with {own:.4g} s"
                )
            return theirs
        if kind == "none" and own > 0.0:
            self.differs.append(
                f"has no derivative filter, the controller one of {own:.4g} s: noise acts more"
            )
            return 0.0
        if kind == "unpublished":
            self.notes.append(
                f"the filter of its derivative is not published; the check takes {own:.4g} s"
            )
        return own

    def _weight(self, wanted: float) -> float:
        weights = self.block.weights
        if not weights:
            kept = min(1.0, max(0.0, wanted))
        else:
            kept = min(weights, key=lambda weight: abs(weight - wanted))
        if not math.isclose(kept, wanted, rel_tol=1e-9, abs_tol=1e-12):
            self.differs.append(
                f"weighs the setpoint with {kept:g}, the controller in this form with "
                f"{wanted:.4g}: setpoint steps differ"
            )
        return kept

    def _given(self, parameter: Parameter) -> bool:
        if parameter.kind in INTEGRAL_KINDS:
            return self.tuning.has_integral
        if parameter.kind in DERIVATIVE_KINDS:
            return self.tuning.has_derivative
        if parameter.kind in LIMIT_KINDS:
            return all(map(math.isfinite, self.tuning.limits))
        return True

    def _setting(
        self, parameter: Parameter, numbers: FilteredPid, derivative_on: DerivativeOn
    ) -> Setting:
        value = self.units.value(parameter, numbers, derivative_on)
        text = printed_number(value, parameter.resolution)
        if float(text) == 0.0 and value != 0.0 and parameter.kind != "reduced setpoint weight":
            raise InputError(
                f"{self.place}, {parameter.name}", f"{value:.3g} {parameter.unit}".strip(),
                f"at least half the block's step of {parameter.resolution:g} {parameter.unit}",
                "take another block, or another unit of the parameter",
            )  # fmt: skip
        self._check_range(parameter, float(text))
        return Setting(parameter.name, text, self.units.unit(parameter))

    def _check_range(self, parameter: Parameter, value: float) -> None:
        low, high = parameter.low, parameter.high
        if (low is not None and value < low) or (high is not None and value > high):
            ends = f"from {low:g}" if low is not None else ""
            ends += f" to {high:g}" if high is not None else ""
            unit = self.units.unit(parameter)
            self.differs.append(
                f"takes {parameter.name} {ends.strip()} {unit}".rstrip() + f", not {value:g}"
            )

    def _choices(
        self, target: FilteredPid, derivative_on: DerivativeOn
    ) -> tuple[tuple[str, str], ...]:
        block, derivative = self.block, self.tuning.has_derivative
        switches = (
            (block.action, self.tuning.action == "reverse"),
            (block.weight_choice, target.setpoint_weight == 1.0),
            (block.derivative_choice if derivative else None, derivative_on == "measurement"),
        )
        return tuple(
            (switch[0], switch[1] if first else switch[2]) for switch, first in switches if switch
        )

    def _say_the_rest(self) -> None:
        tuning, block = self.tuning, self.block
        series = (block.form == "series", tuning.form.algorithm == "series")
        if series[0] != series[1] and tuning.has_derivative and tuning.has_integral:
            self.notes.append(
                "series and other forms are equal in continuous time; sampled, they differ by "
                "about the share that a sampling period is of the integral time"
            )
        if tuning.form.algorithm == "velocity":
            self.notes.append(
                "the controller has the velocity form, which cannot wind up: a block with an "
                "integral leaves its limits otherwise"
            )
        if not tuning.has_integral:
            self.notes.append("without integral action the output at rest is a bias to be entered")
        open_points = block.not_confirmed
        if tuning.has_derivative:
            open_points += block.not_confirmed_of_derivative
        self.notes += [f"not confirmed by a document: {words}" for words in open_points]
