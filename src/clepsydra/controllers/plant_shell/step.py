"""One scan of the plant shell, as equations around those of the law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.validity import any_of, is_number
from clepsydra.controllers.plant_shell.dependence import needed_by_outputs
from clepsydra.controllers.plant_shell.fail_safe import Command
from clepsydra.controllers.plant_shell.members import Members
from clepsydra.controllers.plant_shell.output_limits import MovingLimits, moving_limits
from clepsydra.controllers.plant_shell.scan_time import scan_time_off
from clepsydra.controllers.plant_shell.sensor_diagnosis import Diagnosis
from clepsydra.controllers.plant_shell.setpoint_ramp import RampedValue
from clepsydra.controllers.plant_shell.start import Start, started
from clepsydra.controllers.plant_shell.status import bit_of, shell_status_word
from clepsydra.controllers.plant_shell.watchdog import next_count
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, StepLaw, Symbols


class ShellStep:
    """The equations of the shell of a law.

    Parameters
    ----------
    law : StepLaw
        Without the shell.
    members : Members
    state : sequence of Signal or DelayRing
        Of the law, and what the shell adds but for the scans since the start.
    initial : mapping
        State name to initial value.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> ShellStep(multiloop_pid_law(2), Members((), (), (), {}, {}, 1, {}, ()), [], {}).limited
    {1, 2}
    """

    def __init__(
        self,
        law: StepLaw,
        members: Members,
        state: Sequence[Signal | DelayRing],
        initial: Mapping[str, float],
    ) -> None:
        self.law, self.members, self.state, self.initial = law, members, state, initial
        numbers = range(1, sum(s.name.startswith("manipulated_") for s in law.outputs) + 1)
        known = {parameter.name for parameter in law.parameters}
        self.limited = {i for i in numbers if {f"low_limit_{i}", f"high_limit_{i}"} <= known}
        self.own_rates = {f"rate_limit_{i}" for i in numbers} & known
        kept = {entry.name for entry in law.state}
        self.unremembered = [i for i in numbers if f"last_output_{i}" not in kept]
        self.sensors = needed_by_outputs(law, len(numbers), ("measurement", "sensor"))
        # A setpoint that stands fixed in the law is no business of the shell.
        ramped = {setpoint.number for setpoint in members.setpoints}
        self.setpoints = [
            tuple(j for j in needed if j in ramped)
            for needed in needed_by_outputs(law, len(numbers), ("setpoint",))
        ]

    def equations(self, symbols: Symbols) -> Equations:
        """Write one scan: judge, command, limit, let the law compute, and tell."""
        start = started(symbols, self.state, self.initial)
        now = {**symbols, **start.state}
        sensors = [sensor.diagnosed(now, start.anew) for sensor in self.members.sensors]
        commands = [
            output.commanded(now, [sensors[j - 1] for j in needed], start)
            for output, needed in zip(self.members.outputs, self.sensors, strict=True)
        ]
        setpoints = self._ramped(now, sensors, commands, start)
        reach = {
            i: moving_limits(now, i, now[f"last_output_{i}"], ca.logic_not(commands[i - 1].safe))
            for i in self.members.rates
        }
        given = now | self._given(now, sensors, commands, setpoints, reach)
        next_state, outputs, between = self._computed(given)
        off = scan_time_off(now, start.anew)
        told: dict[str, ca.SX] = {}
        for i, command in enumerate(commands, start=1):
            # Whatever the law makes of it: a fail-safe value is what stands at the actuator.
            value = given[f"tracking_{i}"]
            stands = ca.logic_and(command.safe, is_number(value))
            moved = ca.if_else(stands, value, outputs[f"manipulated_{i}"])
            told[f"manipulated_{i}"] = moved
            told[f"status_{i}"] = self._status(
                now, i, moved, outputs[f"status_{i}"], command, sensors, setpoints, reach, off
            )
        for i in self.unremembered:
            next_state[f"last_output_{i}"] = told[f"manipulated_{i}"]
        count = next_count(now["scans_counted"])
        next_state |= {"scans_counted": count, **start.next_state}
        named: dict[str, ca.SX] = {}
        parts: list[Diagnosis | Command | RampedValue] = [*sensors, *commands, *setpoints]
        for part in parts:
            next_state |= part.next_state
            named |= part.named
        named |= {"cold_start": start.cold, "warm_start": start.warm, "scan_time_off": off}
        taken = {*symbols, *told, *between}
        named = {name: value for name, value in named.items() if name not in taken}
        # The law's own names first: of two names for one value the first is printed.
        return Equations(next_state, {**told, "watchdog": count}, {**between, **named})

    def _ramped(
        self,
        now: Symbols,
        sensors: Sequence[Diagnosis],
        commands: Sequence[Command],
        start: Start,
    ) -> list[RampedValue]:
        found = []
        for setpoint in self.members.setpoints:
            users = [
                command.in_force
                for command, needed in zip(commands, self.setpoints, strict=True)
                if setpoint.number in needed
            ]
            in_force = any_of(users or [command.in_force for command in commands])
            place = setpoint.measurement
            measured = None if place is None else sensors[place - 1]
            found.append(setpoint.ramped(now, measured, in_force, start.first))
        return found

    def _given(
        self,
        now: Symbols,
        sensors: Sequence[Diagnosis],
        commands: Sequence[Command],
        setpoints: Sequence[RampedValue],
        reach: Mapping[int, MovingLimits],
    ) -> dict[str, ca.SX]:
        """Return what the law gets in the place of its inputs and parameters."""
        given: dict[str, ca.SX] = {}
        for j, sensor in enumerate(sensors, start=1):
            given |= {f"measurement_{j}": sensor.value, f"sensor_{j}": sensor.good}
        for j, setpoint in enumerate(setpoints, start=1):
            given[f"setpoint_{j}"] = setpoint.value
        for i, command in enumerate(commands, start=1):
            safe = now[f"fail_safe_{i}"]
            if i in self.limited:
                low, high = now[f"low_limit_{i}"], now[f"high_limit_{i}"]
                safe = limit(ca.if_else(is_number(safe), safe, low), low, high)
            tracking = ca.if_else(command.takes_up, now[f"last_output_{i}"], now[f"tracking_{i}"])
            given[f"tracking_{i}"] = ca.if_else(command.safe, safe, tracking)
            given[f"mode_{i}"] = command.mode
            if f"rate_limit_{i}" in self.own_rates:
                own = now[f"rate_limit_{i}"]
                given[f"rate_limit_{i}"] = ca.if_else(command.safe, signals.LARGEST_PARAMETER, own)
        for i, limits in reach.items():
            given |= {f"low_limit_{i}": limits.moving.low, f"high_limit_{i}": limits.moving.high}
        return given

    def _computed(
        self, given: Mapping[str, ca.SX]
    ) -> tuple[dict[str, ca.SX], dict[str, ca.SX], dict[str, ca.SX]]:
        """Return next state, outputs and intermediates of the law."""
        law = self.law
        groups = (law.state, law.inputs, law.parameters)
        arguments = [ca.vertcat(*(given[entry.name] for entry in group)) for group in groups]
        results = [ca.vertsplit(ca.densify(each)) for each in law.function(*arguments)]
        next_state, outputs, between = (
            {entry.name: value for entry, value in zip(group, values, strict=True)}
            for group, values in zip(
                (law.state, law.outputs, law.intermediates), results, strict=True
            )
        )
        return next_state, outputs, between

    def _status(
        self,
        now: Symbols,
        i: int,
        moved: ca.SX,
        word: ca.SX,
        command: Command,
        sensors: Sequence[Diagnosis],
        setpoints: Sequence[RampedValue],
        reach: Mapping[int, MovingLimits],
        off: ca.SX,
    ) -> ca.SX:
        """Return the status word of output i, with what the law tells in its own."""
        needed = [sensors[j - 1] for j in self.sensors[i - 1]]
        followed = [setpoints[j - 1] for j in self.setpoints[i - 1]]
        lost = [ca.logic_not(number) for number in _numbers(needed, followed)]
        faulty = [ca.logic_not(sensor.good) for sensor in needed]
        mode, latched = now[f"mode_{i}"], command.latched
        at_low, at_high = bit_of(word, "at_low_limit"), bit_of(word, "at_high_limit")
        if i in self.limited:
            at_low = moved <= now[f"low_limit_{i}"]
            at_high = moved >= now[f"high_limit_{i}"]
        hurried = [reach[i].hurried(moved)] if i in reach else []
        uncertain = [sensor.uncertain for sensor in needed]
        ramping = [setpoint.ramps for setpoint in followed]
        return shell_status_word(
            {
                "automatic": mode == Mode.AUTOMATIC,
                "tracking": mode == Mode.TRACKING,
                "at_low_limit": at_low,
                "at_high_limit": at_high,
                "sensor_fault": bit_of(word, "sensor_fault"),
                "invalid_input": any_of([bit_of(word, "invalid_input"), *lost]),
                "invalid_time_step": bit_of(word, "invalid_time_step"),
                "at_rate_limit": any_of([bit_of(word, "at_rate_limit"), *hurried]),
                "sensor_uncertain": _any(uncertain),
                "rides_through": ca.logic_and(_any(faulty), ca.logic_not(latched)),
                "failed_safe": latched,
                "scan_time_off": off,
                "setpoint_ramps": ca.logic_and(_any(ramping), command.in_force),
            }
        )


def _any(conditions: list[ca.SX]) -> ca.SX:
    return any_of(conditions) if conditions else ca.SX(0)


def _numbers(needed: Sequence[Diagnosis], followed: Sequence[RampedValue]) -> list[ca.SX]:
    return [*(sensor.number for sensor in needed), *(setpoint.number for setpoint in followed)]
