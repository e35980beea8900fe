"""Numbers of a PID in the units of a vendor's block, and what the printed ones mean."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.controllers.pid_form import DerivativeOn
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid
from clepsydra.deploy.vendor_tuning.printed_gain import engineering_unit
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.deploy.vendor_tuning.vendor_block import Kind, Parameter, VendorBlock
from clepsydra.designs.gain_units import gain_factor, gain_from_percent, percent_gain


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
        if parameter.kind not in ("gain", "integral gain", "derivative gain"):
            return parameter.unit
        if percent and parameter.unit:
            return parameter.unit
        gain = engineering_unit(self.tuning.measurement, self.tuning.moved)
        return f"{'%/%' if percent else gain} {parameter.unit}".strip()

    def value(
        self, parameter: Parameter, numbers: FilteredPid, derivative_on: DerivativeOn
    ) -> float:
        """Return what a parameter has to be for numbers in the block's form."""
        gain, integral_time, derivative_time, filter_time, weight = numbers
        gain, length = self._of_gain(gain), parameter.seconds
        values: dict[Kind, float] = {
            "gain": gain,
            "proportional band": 100.0 / gain,
            "integral time": integral_time / length,
            "repeats": length / integral_time,
            "integral gain": gain * length / integral_time,
            "derivative time": derivative_time / length,
            "derivative gain": gain * derivative_time / length,
            "filter time": filter_time / length,
            "filter ratio": filter_time / derivative_time if derivative_time else math.nan,
            "setpoint weight": weight,
            "reduced setpoint weight": 1.0 - weight,
            "derivative weight": 1.0 if derivative_on == "error" else 0.0,
        }
        return values[parameter.kind]

    def meant(self, settings: Sequence[Setting], target: FilteredPid) -> FilteredPid:
        """Return what the printed numbers mean, in the block's form; gains come first."""
        found = target._asdict()
        kinds = {parameter.name: parameter for parameter in self.block.parameters}
        gain = self._of_gain(target.gain)
        for setting in settings:
            parameter, value = kinds[setting.name], setting.value
            length = parameter.seconds
            match parameter.kind:
                case "gain" | "proportional band":
                    gain = value if parameter.kind == "gain" else 100.0 / value
                    found["gain"] = self._gain_of(gain)
                case "integral time":
                    found["integral_time"] = value * length
                case "repeats":
                    found["integral_time"] = length / value
                case "integral gain":
                    found["integral_time"] = gain * length / value
                case "derivative time":
                    found["derivative_time"] = value * length
                case "derivative gain":
                    found["derivative_time"] = value * length / gain
                case "filter time":
                    found["filter_time"] = value * length
                case "filter ratio":
                    found["filter_time"] = value * found["derivative_time"]
                case "setpoint weight":
                    found["setpoint_weight"] = value
                case "reduced setpoint weight":
                    found["setpoint_weight"] = 1.0 - value
        if isinstance(self.block.derivative_filter, float):
            found["filter_time"] = found["derivative_time"] / self.block.derivative_filter
        return FilteredPid(**found)
