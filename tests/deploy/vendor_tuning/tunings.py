"""Tunings of one loop that the tests fill blocks with."""

from clepsydra import PidForm, Signal
from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid
from clepsydra.deploy.vendor_tuning.standard_tuning import StandardTuning
from clepsydra.deploy.vendor_tuning.vendor_block import EVERY_BLOCK

BLOCKS = {block.key: block for block in EVERY_BLOCK}

#: 0 to 500 cm, and 0 to 10 V: 4 V/m is 0.04 V/cm and 2 %/%.
LEVEL = Signal("level", "m", display_unit="cm", low=0.0, high=5.0)
PUMP = Signal("pump", "V", low=0.0, high=10.0)


def tuning(gain=4.0, integral_time=120.0, derivative_time=0.0, filter_time=0.0, weight=1.0,
           form=None, measurement=LEVEL, moved=PUMP):  # fmt: skip
    actions = "PID" if derivative_time else "PI"
    settings = FilteredPid(gain, integral_time, derivative_time, filter_time, weight)
    return StandardTuning("loop", measurement, moved, form or PidForm(actions), settings, True)
