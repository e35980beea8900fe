"""Numbers of a PID in the units of a vendor's block, and what the printed ones mean."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from clepsydra.base.units import from_si
from clepsydra.controllers.pid_form import DerivativeOn
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid
from clepsydra.deploy.vendor_tuning.printed_gain import engineering_unit
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.deploy.vendor_tuning.vendor_block import (
    LIMIT_KINDS,
    Kind,
    Parameter,
    VendorBlock,
)
from clepsydra.designs.gain_units import gain_factor, gain_from_percent, percent_gain

Way = Callable[[float], float]


@dataclass(frozen=True)
class Setting:
    """One parameter of a block, with the number as it is printed: the check computes with it."""

    name: str
    text: str
    unit: str

    @property
    def value(self) -> float:
        """The number [unit]."""
        return float(self.text)

    @property
    def words(self) -> str:
        """Name, number and unit."""
        return f"{self.name} = {self.text} {self.unit}".strip()


@dataclass(frozen=True)
class BlockUnits:
    """The units of a block for one loop: its gain in percent of ranges, or in display units."""

    block: VendorBlock
    tuning: StandardTuning

    def _of_gain(self, gain: float) -> float:
        """Return a gain as the block has it."""
        tuning, sign = self.tuning, self.block.sign
        if self.block.gain_in == "percent":
            shown = percent_gain(gain, tuning.measurement, tuning.moved)
        else:
            shown = gain * gain_factor(tuning.measurement, tuning.moved)
        return abs(shown) if sign == "switch" else -shown if sign == "opposite gain" else shown

    def _gain_of(self, shown: float) -> float:
        """Return the gain that the block's stands for."""
        tuning, sign = self.tuning, self.block.sign
        if sign == "switch":
            shown = math.copysign(shown, tuning.settings.gain)
        elif sign == "opposite gain":
            shown = -shown
        if self.block.gain_in == "percent":
            return gain_from_percent(shown, tuning.measurement, tuning.moved)
        return shown / gain_factor(tuning.measurement, tuning.moved)

    def unit(self, parameter: Parameter) -> str:
        """Return the unit of a parameter as it is printed."""
        percent = self.block.gain_in == "percent"
        if parameter.kind in LIMIT_KINDS:
            return self.tuning.moved.shown_unit
        if parameter.kind not in ("gain", "integral gain", "derivative gain"):
            return parameter.unit
        if percent and parameter.unit:
            return parameter.unit
        gain = engineering_unit(self.tuning.measurement, self.tuning.moved)
        return f"{'%/%' if percent else gain} {parameter.unit}".strip()

    def _ways(self, numbers: FilteredPid, parameter: Parameter) -> dict[Kind, tuple[str, Way, Way]]:
        """Return by kind which number a parameter shows, how it does, and the way back."""
        gain, td, length = self._of_gain(numbers.gain), numbers.derivative_time, parameter.seconds

        def times(factor: float, over: float = 1.0) -> tuple[Way, Way]:
            return lambda x: x * factor / over, lambda shown: shown * over / factor

        def by(amount: float) -> tuple[Way, Way]:
            return lambda x: amount / x, lambda shown: amount / shown

        weight: tuple[Way, Way] = (lambda x: 1.0 - x, lambda shown: 1.0 - shown)
        of_gain, gain_of = self._of_gain, self._gain_of
        return {
            "gain": ("gain", of_gain, gain_of),
            "proportional band": (
                "gain", lambda x: 100.0 / of_gain(x), lambda shown: gain_of(100.0 / shown)
            ),
            "integral time": ("integral_time", *times(1.0, length)),
            "repeats": ("integral_time", *by(length)),
            "integral gain": ("integral_time", *by(gain * length)),
            "derivative time": ("derivative_time", *times(1.0, length)),
            "derivative gain": ("derivative_time", *times(gain, length)),
            "filter time": ("filter_time", *times(1.0, length)),
            "filter ratio": ("filter_time", *times(1.0, td or math.nan)),
            "setpoint weight": ("setpoint_weight", *times(1.0)),
            "reduced setpoint weight": ("setpoint_weight", *weight),
        }  # fmt: skip

    def value(
        self, parameter: Parameter, numbers: FilteredPid, derivative_on: DerivativeOn
    ) -> float:
        """Return what a parameter has to be for numbers in the block's form."""
        if parameter.kind == "derivative weight":
            return 1.0 if derivative_on == "error" else 0.0
        if parameter.kind in LIMIT_KINDS:
            moved, end = self.tuning.moved, self.tuning.limits[LIMIT_KINDS.index(parameter.kind)]
            return from_si(end, moved.unit, moved.shown_unit)
        name, shown, _ = self._ways(numbers, parameter)[parameter.kind]
        return shown(getattr(numbers, name))

    def meant(self, settings: Sequence[Setting], target: FilteredPid) -> FilteredPid:
        """Return what the printed numbers mean, in the block's form; gains come first."""
        kinds = {parameter.name: parameter for parameter in self.block.parameters}
        for setting in settings:
            parameter = kinds[setting.name]
            if parameter.kind not in ("derivative weight", *LIMIT_KINDS):
                name, _, back = self._ways(target, parameter)[parameter.kind]
                target = target._replace(**{name: back(setting.value)})
        if isinstance(ratio := self.block.derivative_filter, float):
            target = target._replace(filter_time=target.derivative_time / ratio)
        return target
