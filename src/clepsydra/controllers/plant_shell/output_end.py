"""One output of the shell: what the law gets for it, and what stands at the actuator."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.ports import as_parts
from clepsydra.controllers.blocks.validity import all_of, any_of, is_number
from clepsydra.controllers.plant_shell.fail_safe import SafeOutput
from clepsydra.controllers.plant_shell.output_limits import REACH
from clepsydra.controllers.plant_shell.scan import Scan
from clepsydra.controllers.plant_shell.status import STATUS_WORD
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.program.step_law import Symbols


class OutputEnd:
    """An output in one scan, before and after the law.

    Parameters
    ----------
    scan : Scan
    output : SafeOutput
    command : mapping
        Who moves it (`SafeOutput.commanded`).
    rated : bool
        Whether the shell limits its rate.

    Examples
    --------
    See `ShellStep`.
    """

    def __init__(self, scan: Scan, output: SafeOutput, command: Symbols, *, rated: bool) -> None:
        self.scan, self.command, self.signal = scan, command, output.signal
        none = ca.SX(LARGEST_PARAMETER)
        #: What the law and the shell have of this output, by part.
        own = self.own = {
            part: scan.symbols[name]
            for part in ("mode", "tracking", "fail_safe", "low_limit", "high_limit", "rate_limit")
            if (name := path(self.signal, part)) in scan.symbols
        }
        last, safe = scan.used(path(self.signal, "last_output")), own["fail_safe"]
        given = {"mode": command["mode_used"]}
        if "rate_limit" in own and not rated:
            given["rate_limit"] = ca.if_else(command["moves"], own["rate_limit"], none)
        self.reach: dict[str, ca.SX] = {}
        if {"low_limit", "high_limit"} <= set(own):
            self.reach = scan.call(
                REACH, path(self.signal, "reach"), self.signal,
                last_output=last, moves=command["moves"],
                rate_limit=own["rate_limit"] if rated else none,
            )  # fmt: skip
            safe = self.reach["fail_safe_used"]
            given["low_limit"], given["high_limit"] = (
                self.reach["low_used"],
                self.reach["high_used"],
            )
        followed = ca.if_else(command["follows"], last, own["tracking"])
        self.tracking = given["tracking"] = ca.if_else(command["safe"], safe, followed)
        #: What the law gets in the place of its inputs and parameters.
        self.given = as_parts(self.signal, given)
        #: Names for values on the way.
        self.named = {path(self.signal, "tracked"): self.tracking}

    def stands(self, asked: ca.SX) -> ca.SX:
        """Return what stands at the actuator: what the law asks for, or the fail-safe value."""
        safe = ca.logic_and(self.command["safe"], is_number(self.tracking))
        return ca.if_else(safe, self.tracking, asked)

    def status(
        self, output: ca.SX, law: Symbols, sensors: Sequence[Symbols], setpoints: Sequence[Symbols]
    ) -> ca.SX:
        """Return the status word.

        Parameters
        ----------
        output : casadi.SX
            What stands at the actuator.
        law : mapping
            The bits that only the law knows (`LawBlock.bits`).
        sensors, setpoints : sequence of mapping
            Those that the output needs, as their blocks tell of them.
        """
        scan, command, mode = self.scan, self.command, self.own["mode"]
        bits = dict(law)
        if self.reach:
            low, high = self.own["low_limit"], self.own["high_limit"]
            inside = ca.logic_and(output > low, output < high)
            ends = [output <= self.reach["low_used"], output >= self.reach["high_used"]]
            at_end = self.named[path(self.signal, "at_end")] = any_of(ends)
            # At a limit of the actuator it is that which holds it.
            hurried = all_of([self.reach["rate_acts"], inside, at_end])
            bits |= {"at_low_limit": output <= low, "at_high_limit": output >= high}
            bits["at_rate_limit"] = ca.logic_or(law["at_rate_limit"], hurried)
        numbers = [*(each["is_number"] for each in sensors), *(each["given"] for each in setpoints)]
        bits |= {
            "automatic": mode == Mode.AUTOMATIC,
            "tracking": mode == Mode.TRACKING,
            "invalid_input": any_of([law["invalid_input"], *map(ca.logic_not, numbers)]),
            "sensor_uncertain": _any(sensors, "uncertain"),
            "rides_through": ca.logic_not(ca.logic_or(command["good"], command["latched"])),
            "failed_safe": command["latched"],
            "scan_time_off": scan["scan_time_off"],
            "setpoint_ramps": ca.logic_and(_any(setpoints, "ramps"), command["in_force"]),
            "following": command["follows"],
            "setpoint_limited": _any(setpoints, "limited"),
        }
        return scan.call(STATUS_WORD, path(self.signal, "status_word"), **bits)["status"]


def _any(parts: Sequence[Symbols], port: str) -> ca.SX:
    return any_of([ca.SX(0), *(part[port] for part in parts)])
