"""Numbers of a PID in the units of a vendor's block, and what the printed ones mean."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.controllers.pid_form import DerivativeOn
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.deploy.vendor_tuning.vendor_block import Kind, Parameter, VendorBlock
from clepsydra.designs.gain_units import gain_from_percent, percent_gain

#: Significant digits that are printed.
DIGITS = 5


@dataclass(frozen=True)
class Setting:
    """One parameter of a block with its value as it is printed.

    Parameters
    ----------
    name : str
        The vendor's.
    text : str
        The number; it is what the check computes with.
    unit : str
        Empty of a pure number.

    Examples
    --------
    >>> Setting("Ti", "0.5", "min").words
    'Ti = 0.5 min'
    """

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


def printed_number(value: float, resolution: float = 0.0) -> str:
    """Return a number as it is printed: five significant digits, in the block's steps.

    Examples
    --------
    >>> printed_number(1.0 / 3.0), printed_number(1.0 / 3.0, 0.01), printed_number(3.0e-7)
    ('0.33333', '0.33', '3e-07')
    """
    if resolution:
        value = round(round(value / resolution) * resolution, 12)
    return f"{value:.{DIGITS}g}"


@dataclass(frozen=True)
class BlockUnits:
    """The units of a block for one loop: its gain in percent of ranges, or in display units.

    Parameters
    ----------
    block : VendorBlock
    tuning : StandardTuning

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.controllers.pid_form import PidForm
    >>> from clepsydra.deploy.vendor_tuning.vendors.every_block import vendor_block
    >>> level, pump = Signal("level", "m", low=0.0, high=5.0), Signal("pump", "V", low=0, high=10)
    >>> tuning = StandardTuning("k", level, pump, PidForm(), FilteredPid(-4.0, 120.0), True)
    >>> units = BlockUnits(vendor_block("siemens-cont-c"), tuning)
    >>> units.of_gain(-4.0), units.gain_of(-2.0)
    (-2.0, -4.0)
    """

    block: VendorBlock
    tuning: StandardTuning

    def of_gain(self, gain: float) -> float:
        """Return a gain as the block has it."""
        tuning, sign = self.tuning, self.block.sign
        if self.block.gain_in == "percent":
            shown = percent_gain(gain, tuning.measurement, tuning.moved)
        else:
            shown = gain * tuning.engineering_factor
        return abs(shown) if sign == "switch" else -shown if sign == "opposite gain" else shown

    def gain_of(self, shown: float) -> float:
        """Return the gain that the block's stands for."""
        tuning, sign = self.tuning, self.block.sign
        if sign == "switch":
            shown = math.copysign(shown, tuning.settings.gain)
        elif sign == "opposite gain":
            shown = -shown
        if self.block.gain_in == "percent":
            return gain_from_percent(shown, tuning.measurement, tuning.moved)
        return shown / tuning.engineering_factor

    def unit(self, parameter: Parameter) -> str:
        """Return the unit of a parameter as it is printed."""
        if parameter.kind not in ("gain", "integral gain", "derivative gain"):
            return parameter.unit
        gain = "%/%" if self.block.gain_in == "percent" else self.tuning.engineering_unit
        if not parameter.unit:
            return gain
        if self.block.gain_in == "percent":
            return parameter.unit
        return f"{gain} {parameter.unit}"

    def value(
        self, parameter: Parameter, numbers: FilteredPid, derivative_on: DerivativeOn
    ) -> float:
        """Return what a parameter has to be for numbers in the block's form."""
        gain = self.of_gain(numbers.gain)
        length = parameter.seconds
        values: dict[Kind, float] = {
            "gain": gain,
            "proportional band": 100.0 / gain,
            "integral time": numbers.integral_time / length,
            "repeats": length / numbers.integral_time,
            "integral gain": gain * length / numbers.integral_time,
            "derivative time": numbers.derivative_time / length,
            "derivative gain": gain * numbers.derivative_time / length,
            "filter time": numbers.filter_time / length,
            "setpoint weight": numbers.setpoint_weight,
            "reduced setpoint weight": 1.0 - numbers.setpoint_weight,
            "derivative weight": 1.0 if derivative_on == "error" else 0.0,
        }
        if numbers.derivative_time:
            values["filter ratio"] = numbers.filter_time / numbers.derivative_time
        return values[parameter.kind]

    def meant(self, settings: Sequence[Setting], target: FilteredPid) -> FilteredPid:
        """Return what the printed numbers mean, in the block's form; gains come first."""
        found = target
        kinds = {parameter.name: parameter for parameter in self.block.parameters}
        gain = self.of_gain(target.gain)
        for setting in settings:
            parameter, value = kinds[setting.name], setting.value
            seconds, kind = value * parameter.seconds, parameter.kind
            if kind in ("gain", "proportional band"):
                gain = value if kind == "gain" else 100.0 / value
                found = found._replace(gain=self.gain_of(gain))
            elif kind == "integral time":
                found = found._replace(integral_time=seconds)
            elif kind == "repeats":
                found = found._replace(integral_time=parameter.seconds / value)
            elif kind == "integral gain":
                found = found._replace(integral_time=gain * parameter.seconds / value)
            elif kind == "derivative time":
                found = found._replace(derivative_time=seconds)
            elif kind == "derivative gain":
                found = found._replace(derivative_time=seconds / gain)
            elif kind == "filter time":
                found = found._replace(filter_time=seconds)
            elif kind == "filter ratio":
                found = found._replace(filter_time=value * found.derivative_time)
            elif kind == "setpoint weight":
                found = found._replace(setpoint_weight=value)
            elif kind == "reduced setpoint weight":
                found = found._replace(setpoint_weight=1.0 - value)
        if isinstance(self.block.derivative_filter, float):
            found = found._replace(filter_time=found.derivative_time / self.block.derivative_filter)
        return found
