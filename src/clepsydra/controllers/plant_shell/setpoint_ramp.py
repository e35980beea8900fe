"""A setpoint that is always a number within its range and moves no faster than its ramp."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER, is_number
from clepsydra.controllers.plant_shell.ports import largest_rate, of_process
from clepsydra.controllers.plant_shell.scan import Scan
from clepsydra.controllers.plant_shell.scan_watch import STEP_GOOD, TIME_STEP
from clepsydra.controllers.plant_shell.sensor_diagnosis import GOOD, MEASURED
from clepsydra.controllers.plant_shell.start import FIRST
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols


def _ramped(symbols: Symbols) -> Equations:
    raw, last, rate = symbols["setpoint"], symbols["ramped_setpoint"], symbols["setpoint_rate"]
    good, measured, in_force = symbols["good"], symbols["measured"], symbols["in_force"]
    number = is_number(raw)
    # A transmitter may be scaled the other way round.
    ends = symbols["range_low"], symbols["range_high"]
    asked = limit(raw, ca.fmin(*ends), ca.fmax(*ends))
    begin = ca.if_else(good, measured, ca.if_else(number, asked, last))
    before = ca.if_else(symbols["first"], begin, last)
    target = ca.if_else(number, asked, before)
    way = rate * ca.if_else(symbols["step_good"], symbols["time_step"], 0)
    on_its_way = ca.if_else(symbols["held"], before, limit(target, before - way, before + way))
    on_its_way = ca.if_else(in_force, on_its_way, ca.if_else(good, measured, before))
    value = ca.if_else(rate < signals.LARGEST_PARAMETER, on_its_way, target)
    return Equations(
        {"ramped_setpoint": value},
        {
            "setpoint_used": value,
            "given": number,
            "limited": ca.logic_and(number, asked != raw),
            "ramps": ca.logic_and(in_force, value != target),
        },
        {"asked": asked, "before": before, "target": target, "way": way, "on_its_way": on_its_way},
    )


#: The setpoint of a scan. One outside the range is held at the end of it: what it asks for cannot
#: be measured, and one scan of it would fill an integral. A setpoint that is not a number leaves
#: the last one. While no output that needs it is in automatic the ramp stands at the measurement,
#: and there it begins in the first scan. While a fault is ridden through it stands where it is:
#: the output is held, and would jump by what the ramp had gone meanwhile.
RAMP = Block(
    "setpoint_ramp",
    (
        Signal("setpoint", description="what is asked for, in the unit of the measurement"),
        Signal("range_low", description="one end of the range"),
        Signal("range_high", description="the other end"),
        Signal("setpoint_rate", description="largest rate, in its unit a second; 1e9 for none"),
        TIME_STEP,
        STEP_GOOD,
        MEASURED,
        GOOD,
        truth("in_force", "an output that needs the setpoint is in automatic"),
        truth("held", "a sensor is bad that such an output needs"),
        FIRST,
    ),
    (Signal("ramped_setpoint", description="the setpoint that was followed in the last scan"),),
    (
        Signal("setpoint_used", description="the setpoint that the law gets"),
        truth("given", "what is asked for is a number"),
        truth("limited", "what is asked for is a number outside the range"),
        truth("ramps", "the setpoint is still on its way"),
    ),
    _ramped,
    ("A setpoint within its range: ramped in automatic, at the measurement otherwise.",),
)


@dataclass(frozen=True)
class RampedSetpoint:
    """A setpoint of the law behind the shell.

    Parameters
    ----------
    signal : Signal
        What it is the setpoint of, by the law's name.
    measurement : str or None
        The measurement that it is the setpoint of, if the law has it.
    ranged : bool
        Whether that measurement has range_low and range_high, within which it is held; else it is
        held within the range of its signal.
    rate : float
        [unit/s]; the largest parameter is none.

    Examples
    --------
    >>> ramp = RampedSetpoint(Signal("level_1", "V"), "level_1", True, 0.5)
    >>> [parameter.unit for parameter in ramp.parameters()]
    ['V/s']
    """

    signal: Signal
    measurement: str | None
    ranged: bool
    rate: float

    def parameters(self) -> list[Signal]:
        """The largest rate."""
        return [largest_rate("setpoint_rate", self.signal, self.rate)]

    def state(self) -> list[Signal]:
        """The setpoint of the last scan."""
        return [of_process(port, self.signal) for port in RAMP.state]

    def ramped(
        self, scan: Scan, measured: Symbols | None, in_force: ca.SX, held: ca.SX
    ) -> dict[str, ca.SX]:
        """Return the setpoint of this scan, as the outputs of `RAMP`.

        Parameters
        ----------
        scan : Scan
        measured : mapping or None
            Outputs of the check of the measurement that it belongs to; the ramp of a setpoint
            without one counts as always in force.
        in_force, held : casadi.SX
            As the inputs of `RAMP`.
        """
        low, high = self._range(scan)
        return scan.call(
            RAMP, path(self.signal, "ramp"), self.signal,
            setpoint=scan.symbols[path(self.signal, "sp")],
            range_low=low,
            range_high=high,
            measured=measured["measured"] if measured else ca.SX(0),
            good=measured["good"] if measured else ca.SX(0),
            in_force=in_force if measured else ca.SX(1),
            held=held,
        )  # fmt: skip

    def _range(self, scan: Scan) -> tuple[ca.SX, ca.SX]:
        """Return the range; an end that the signal does not have is no limit."""
        if self.measurement and self.ranged:
            y = self.measurement
            return scan[path(y, "range_low")], scan[path(y, "range_high")]
        low = max(self.signal.low, -LARGEST_NUMBER)
        return ca.SX(low), ca.SX(min(self.signal.high, LARGEST_NUMBER))
