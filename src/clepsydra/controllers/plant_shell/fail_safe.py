"""Fail-safe: where an output goes when its sensors fail, and how it comes back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.validity import all_of, any_of
from clepsydra.controllers.plant_shell.ports import count, of_process
from clepsydra.controllers.plant_shell.scan import Scan
from clepsydra.controllers.plant_shell.scan_watch import STEP_GOOD
from clepsydra.controllers.plant_shell.start import ACKNOWLEDGED, WARM
from clepsydra.program.block import Block
from clepsydra.program.step_law import Equations, Symbols

_LARGEST_COUNT = 1e6
_COUNTED = "scans to follow are counted no further"
_MOST_SCANS = Signal("most_scans", initial=_LARGEST_COUNT, kind="integer", description=_COUNTED)
TAKE_UP_SCANS = count(
    "take_up_scans", _LARGEST_COUNT,
    "scans for which the law follows its last output after a warm start or a fault", low=1.0,
)  # fmt: skip
_NO_MODE = float(max(Mode)) + 1.0


def _commanded(symbols: Symbols) -> Equations:
    mode, before, good = symbols["mode"], symbols["failed_safe"], symbols["good"]
    tracking, automatic = mode == Mode.TRACKING, mode == Mode.AUTOMATIC
    by_hand = ca.logic_or(mode == Mode.MANUAL, tracking)
    cleared = ca.logic_and(good, ca.logic_or(symbols["acknowledged"], by_hand))
    latched = ca.logic_or(symbols["failed"], ca.logic_and(before, ca.logic_not(cleared)))
    safe = ca.logic_and(latched, ca.logic_not(by_hand))
    comes_back = ca.logic_and(before, ca.logic_not(latched))
    begins = ca.logic_or(symbols["warm"], comes_back)
    left = ca.if_else(begins, symbols["take_up_scans"], symbols["scans_to_follow"])
    # Numbers set at run time may be any; single precision holds these as well.
    left = ca.fmin(_LARGEST_COUNT, ca.fmax(0, left))
    follows = ca.logic_and(ca.logic_and(left > 0, automatic), ca.logic_not(safe))
    overruled = ca.logic_or(safe, follows)
    # One that is none stays none.
    bounded = ca.fmin(_NO_MODE, ca.fmax(-1, mode))
    counts = ca.logic_and(good, symbols["step_good"])
    following = ca.if_else(counts, ca.fmax(0, left - 1), left)
    return Equations(
        {"failed_safe": latched, "scans_to_follow": ca.if_else(latched, 0, following)},
        {
            "mode_used": ca.if_else(overruled, float(Mode.TRACKING), bounded),
            "latched": latched,
            "safe": safe,
            "follows": follows,
            "in_force": ca.logic_and(automatic, ca.logic_not(overruled)),
            "moves": ca.logic_not(ca.logic_or(safe, tracking)),
        },
        {"by_hand": by_hand, "scans_left": left, "overruled": overruled},
        {
            "by_hand": "manual and tracking go before a fail-safe value",
            "latched": "latch: a fault holds until good sensors are acknowledged, or moved by hand",
            "scans_left": "how many scans the law is still to follow",
            "follows": "before the law moves the output again, it follows what that was last",
            "overruled": "what the law asks for does not count",
            "mode_used": "a law that is overruled tracks",
            "safe": "the output goes to its fail-safe value",
            "in_force": "the law moves the output",
            "moves": "the rate limit acts: in automatic and by hand",
            "scans_to_follow": "a scan counts where its sensors and its time step are good",
        },
    )


#: Who moves an output in a scan. Where a needed sensor has failed the output goes to its fail-safe
#: value, and stays there until good sensors are acknowledged, or the output is moved by hand while
#: they are good; who acknowledges bad sensors has to do it again. That holds in a mode that is
#: none, too. An operator who moves it by hand, or a controller that it tracks, always goes first.
#:
#: Coming back, and after a warm start, the law follows the last output for as many scans as it
#: needs to take it up at the present measurements (`plant_shell.take_up`); scans without good
#: sensors do not count.
COMMAND = Block(
    "output_command",
    (
        count("mode", float(max(Mode)), "0 manual, 1 automatic, 2 tracking"),
        truth("good", "all sensors are good that the output needs"),
        truth("failed", "one of them has been faulty for longer than its delay"),
        ACKNOWLEDGED,
        WARM,
        STEP_GOOD,
        TAKE_UP_SCANS,
    ),
    (
        truth("failed_safe", "a sensor failed and was not acknowledged"),
        count("scans_to_follow", _LARGEST_COUNT, "scans for which the law has yet to follow"),
    ),
    (
        count("mode_used", _NO_MODE, "the mode that the law gets", low=-1.0),
        truth("latched", "a fault has outlasted its delay and was not acknowledged since"),
        truth("safe", "the output is brought to its fail-safe value"),
        truth("follows", "the law follows its last output, to go on from it in the next scan"),
        truth("in_force", "the law moves the output"),
        truth(
            "moves",
            "the controller moves the actuator, by the law or by hand, at its rate: in tracking "
            "somebody else does, and a fail-safe value is not slowed",
        ),
    ),
    _commanded,
    ("Who moves an output: mode, latched fail-safe, and the way back into automatic.",),
    (_MOST_SCANS,),
)


@dataclass(frozen=True)
class SafeOutput:
    """An output with a fail-safe value.

    Parameters
    ----------
    signal : Signal
        The manipulated variable.
    value : float
        Fail-safe value [unit].

    Examples
    --------
    >>> [state.name for state in SafeOutput(Signal("pump_1", "V"), 0.0).state()]
    ['pump_1.failed_safe', 'pump_1.scans_to_follow']
    """

    signal: Signal
    value: float

    def parameters(self) -> list[Signal]:
        """The fail-safe value."""
        u = self.signal
        words = f"value of {u.name} after a sensor has failed"
        return [signals.gain(path(u, "fail_safe"), u, self.value, words)]

    def unwired(self) -> dict[str, float]:
        """What its inputs are until somebody wires them: manual, at the fail-safe value."""
        at = {path(self.signal, what): self.value for what in ("manual", "tracking")}
        return {path(self.signal, "mode"): float(Mode.MANUAL), **at}

    def state(self) -> list[Signal]:
        """Whether it has failed, and whether the law has yet to take it up."""
        return [of_process(port, self.signal) for port in COMMAND.state]

    def commanded(self, scan: Scan, needed: Sequence[Symbols]) -> dict[str, ca.SX]:
        """Return who moves the output in this scan, and whether its sensors are good."""
        good = all_of([ca.SX(1), *(sensor["good"] for sensor in needed)])
        failed = any_of([ca.SX(0), *(sensor["failed"] for sensor in needed)])
        name = path(self.signal, "command")
        return {**scan.call(COMMAND, name, self.signal, good=good, failed=failed), "good": good}
