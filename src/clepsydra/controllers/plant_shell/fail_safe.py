"""Fail-safe: where an output goes when its sensors fail, and how it comes back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.validity import is_time_step
from clepsydra.controllers.plant_shell.sensor_diagnosis import Diagnosis
from clepsydra.controllers.plant_shell.start import Start
from clepsydra.program.step_law import Symbols

_LARGEST_COUNT = 1e6


@dataclass(frozen=True)
class Command:
    """Who moves an output in a scan.

    Parameters
    ----------
    mode : casadi.SX
        The mode that the law gets.
    latched : casadi.SX
        Whether a fault has outlasted its delay and was not acknowledged since.
    safe : casadi.SX
        Whether the output is brought to its fail-safe value.
    takes_up : casadi.SX
        Whether the law follows its last output in this scan, to go on from it in the next.
    in_force : casadi.SX
        Whether the law moves the output.
    moves : casadi.SX
        Whether the controller moves the actuator, by the law or by hand, at its rate: in
        tracking somebody else does, and a fail-safe value is not slowed.
    good : casadi.SX
        Whether all sensors are good that the output needs.
    next_state, named : dict

    Examples
    --------
    >>> true, false = ca.SX(1), ca.SX(0)
    >>> bool(Command(ca.SX(2), true, true, false, false, false, true, {}, {}).safe)
    True
    """

    mode: ca.SX
    latched: ca.SX
    safe: ca.SX
    takes_up: ca.SX
    in_force: ca.SX
    moves: ca.SX
    good: ca.SX
    next_state: dict[str, ca.SX]
    named: dict[str, ca.SX]


def acknowledge_input() -> Signal:
    """Return the input by which a fault is acknowledged.

    Examples
    --------
    >>> acknowledge_input().kind
    'boolean'
    """
    return Signal(
        "acknowledge",
        low=0.0,
        high=1.0,
        kind="boolean",
        description="where it becomes true, takes back what a sensor fault latched, if its sensors "
        "are good",
    )


def acknowledge_state() -> Signal:
    """Return the acknowledgement of the last scan.

    Examples
    --------
    >>> acknowledge_state().name
    'last_acknowledge'
    """
    return Signal(
        "last_acknowledge", low=0.0, high=1.0, kind="boolean",
        description="acknowledge in the last scan, so that held it acts once",
    )  # fmt: skip


def acknowledged(symbols: Symbols) -> ca.SX:
    """Return whether somebody acknowledges in this scan: the button was not pressed before.

    Held down, or stuck, it would take back every later fault by itself.

    Examples
    --------
    >>> symbols = {"acknowledge": ca.DM(1), "last_acknowledge": ca.DM(1)}
    >>> bool(acknowledged(symbols))
    False
    """
    return ca.logic_and(symbols["acknowledge"], ca.logic_not(symbols["last_acknowledge"]))


@dataclass(frozen=True)
class SafeOutput:
    """An output with a fail-safe value.

    Parameters
    ----------
    number : int
        i of manipulated_i.
    signal : Signal
        The manipulated variable.
    value : float
        Fail-safe value [unit].

    Examples
    --------
    >>> [state.name for state in SafeOutput(1, Signal("pump_1", "V"), 0.0).state()]
    ['failed_safe_1', 'scans_to_follow_1']
    """

    number: int
    signal: Signal
    value: float

    def parameters(self) -> list[Signal]:
        """The fail-safe value."""
        u = self.signal
        words = f"value of {u.name} after a sensor has failed"
        return [signals.gain(f"fail_safe_{self.number}", u.unit, self.value, words)]

    def unwired(self) -> dict[str, float]:
        """What its inputs are until somebody wires them: manual, at the fail-safe value."""
        i = self.number
        at = {f"manual_{i}": self.value, f"tracking_{i}": self.value}
        return {f"mode_{i}": float(Mode.MANUAL), **at}

    def state(self) -> list[Signal]:
        """Whether it has failed, and whether the law has yet to take it up."""
        i, u = self.number, self.signal
        return [
            Signal(
                f"failed_safe_{i}", low=0.0, high=1.0, kind="boolean",
                description=f"a sensor of {u.name} failed and was not acknowledged",
            ),
            Signal(
                f"scans_to_follow_{i}", low=0.0, high=_LARGEST_COUNT, kind="integer",
                description=f"scans for which the law has yet to follow {u.name}",
            ),
        ]  # fmt: skip

    def commanded(
        self, symbols: Symbols, needed: Sequence[Diagnosis], start: Start, pressed: ca.SX
    ) -> Command:
        """Return who moves the output in this scan.

        Where a needed sensor has failed the output goes to its fail-safe value, and stays there
        until good sensors are acknowledged, or the output is moved by hand while they are good;
        who acknowledges bad sensors has to do it again. That holds in a mode that is none, too.
        An operator who moves it by hand, or a controller that it tracks, always goes first.

        Coming back, and after a warm start, the law follows the last output for as many scans as
        it needs to take it up at the present measurements (`plant_shell.take_up`); scans without
        good sensors do not count.
        """
        i = self.number
        mode, latched = symbols[f"mode_{i}"], symbols[f"failed_safe_{i}"]
        tracking = mode == Mode.TRACKING
        by_hand = ca.logic_or(mode == Mode.MANUAL, tracking)
        automatic = mode == Mode.AUTOMATIC
        good, fails = ca.SX(1), ca.SX(0)
        for sensor in needed:
            good, fails = ca.logic_and(good, sensor.good), ca.logic_or(fails, sensor.failed)
        cleared = ca.logic_and(good, ca.logic_or(pressed, by_hand))
        latch = ca.logic_or(fails, ca.logic_and(latched, ca.logic_not(cleared)))
        safe = ca.logic_and(latch, ca.logic_not(by_hand))
        comes_back = ca.logic_and(latched, ca.logic_not(latch))
        begins = ca.logic_or(start.warm, comes_back)
        left = ca.if_else(begins, symbols["take_up_scans"], symbols[f"scans_to_follow_{i}"])
        # Numbers set at run time may be any; single precision holds these as well.
        left = to_follow = ca.fmin(_LARGEST_COUNT, ca.fmax(0, left))
        takes_up = ca.logic_and(ca.logic_and(left > 0, automatic), ca.logic_not(safe))
        ready = ca.logic_and(good, is_time_step(symbols["time_step"]))
        left = ca.if_else(latch, 0, ca.if_else(ready, ca.fmax(0, left - 1), left))
        overruled = ca.logic_or(safe, takes_up)
        in_force = ca.logic_and(automatic, ca.logic_not(overruled))
        moves = ca.logic_not(ca.logic_or(safe, tracking))
        mode_used = ca.if_else(overruled, float(Mode.TRACKING), mode)
        return Command(
            mode=mode_used,
            latched=latch,
            safe=safe,
            takes_up=takes_up,
            in_force=in_force,
            moves=moves,
            good=good,
            next_state={
                f"failed_safe_{i}": latch,
                f"scans_to_follow_{i}": left,
            },
            named={
                f"safe_{i}": safe,
                f"following_{i}": takes_up,
                f"mode_used_{i}": mode_used,
                f"automatic_asked_{i}": automatic,
                f"tracking_asked_{i}": tracking,
                f"manual_or_tracking_{i}": by_hand,
                f"sensors_good_{i}": good,
                f"fault_latched_{i}": latch,
                f"fault_cleared_{i}": cleared,
                f"comes_back_{i}": comes_back,
                f"begins_to_follow_{i}": begins,
                f"scans_left_{i}": to_follow,
                f"scan_counts_{i}": ready,
                f"law_in_force_{i}": in_force,
                f"controller_moves_{i}": moves,
            },
        )
