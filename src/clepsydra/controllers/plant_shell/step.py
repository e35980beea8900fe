"""One scan of the plant shell, as equations around those of the law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.blocks.validity import any_of, is_number
from clepsydra.controllers.plant_shell.dependence import needed_by_outputs
from clepsydra.controllers.plant_shell.fail_safe import Command, acknowledged
from clepsydra.controllers.plant_shell.members import Members
from clepsydra.controllers.plant_shell.output_limits import MovingLimits, moving_limits
from clepsydra.controllers.plant_shell.scan_time import scan_time_off
from clepsydra.controllers.plant_shell.sensor_diagnosis import Diagnosis
from clepsydra.controllers.plant_shell.setpoint_ramp import RampedValue
from clepsydra.controllers.plant_shell.start import Start, started
from clepsydra.controllers.plant_shell.status import bit_of, bits_from, status_bits
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
        Of the law, and what the shell adds but for `start_states`.
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
        pressed = acknowledged(now)
        commands = [
            output.commanded(now, [sensors[j - 1] for j in needed], start, pressed)
            for output, needed in zip(self.members.outputs, self.sensors, strict=True)
        ]
        setpoints = self._ramped(now, sensors, commands, start)
        reach = {
            i: moving_limits(now, i, now[f"last_output_{i}"], commands[i - 1].moves)
            for i in self.members.rates
        }
        named: dict[str, ca.SX] = {}
        given = now | self._given(now, sensors, commands, setpoints, reach, named)
        next_state, outputs, between = self._computed(given)
        off = scan_time_off(now, start.anew)
        told: dict[str, ca.SX] = {}
        for i, command in enumerate(commands, start=1):
            # Whatever the law makes of it: a fail-safe value is what stands at the actuator.
            value = given[f"tracking_{i}"]
            stands = ca.logic_and(command.safe, is_number(value))
            moved = ca.if_else(stands, value, outputs[f"manipulated_{i}"])
            told[f"manipulated_{i}"] = moved
            word = outputs[f"status_{i}"]
            bits = self._status(now, i, moved, word, command, sensors, setpoints, reach, off)
            told[f"status_{i}"] = sum(bits.values(), ca.SX(0))
            named |= {f"{name}_bit_{i}": bit for name, bit in bits.items()}
            named |= self._names_of_word(i, word) | {f"fail_safe_stands_{i}": stands}
        for i in self.unremembered:
            next_state[f"last_output_{i}"] = told[f"manipulated_{i}"]
        count = next_count(now["scans_counted"])
        next_state |= {"scans_counted": count, "last_acknowledge": now["acknowledge"]}
        next_state |= start.next_state
        parts: list[Diagnosis | Command | RampedValue] = [*sensors, *commands, *setpoints]
        for part in parts:
            next_state |= part.next_state
            named |= part.named
        for limits in reach.values():
            named |= limits.named
        named |= {"cold_start": start.cold, "warm_start": start.warm, "starting": start.anew}
        named |= {"first_scan": start.first, "state_is_kept": ca.logic_not(start.cold)}
        named |= {"acknowledged": pressed, "scan_time_off": off}
        taken = {*symbols, *told, *between}
        # The law's own names first: of two names for one value the first is printed.
        shown = {**between, **{name: named[name] for name in named if name not in taken}}
        for name, value in start.state.items():
            # Where a name says already what is made of the kept value, that one is called kept.
            wanted = (_called(name, "used"), _called(name, "kept"))
            free = [each for each in wanted if each.isidentifier() and each not in taken | {*shown}]
            if free:
                shown[free[0]] = value
        return Equations(next_state, {**told, "watchdog": count}, shown)

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
                command
                for command, needed in zip(commands, self.setpoints, strict=True)
                if setpoint.number in needed
            ] or commands
            in_force = any_of([command.in_force for command in users])
            held = any_of([ca.logic_and(user.in_force, ca.logic_not(user.good)) for user in users])
            place = setpoint.measurement
            measured = None if place is None else sensors[place - 1]
            found.append(setpoint.ramped(now, measured, in_force, held, start.first))
        return found

    def _given(
        self,
        now: Symbols,
        sensors: Sequence[Diagnosis],
        commands: Sequence[Command],
        setpoints: Sequence[RampedValue],
        reach: Mapping[int, MovingLimits],
        named: dict[str, ca.SX],
    ) -> dict[str, ca.SX]:
        """Return what the law gets in the place of its inputs and parameters; name it."""
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
            tracking = ca.if_else(command.safe, safe, tracking)
            given |= {f"tracking_{i}": tracking, f"mode_{i}": command.mode}
            named |= {f"fail_safe_used_{i}": safe, f"tracking_used_{i}": tracking}
            if f"rate_limit_{i}" in self.own_rates:
                rate = ca.if_else(command.moves, now[f"rate_limit_{i}"], signals.LARGEST_PARAMETER)
                given[f"rate_limit_{i}"] = named[f"rate_limit_used_{i}"] = rate
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
    ) -> dict[str, ca.SX]:
        """Return the bits of the status word of output i, with what the law tells in its own."""
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
        return status_bits(
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
                "following": command.takes_up,
                "setpoint_limited": _any([setpoint.limited for setpoint in followed]),
            }
        )

    def _names_of_word(self, i: int, word: ca.SX) -> dict[str, ca.SX]:
        """Return names for the law's own status word and for what its bits are read from."""
        named = {f"law_status_{i}": word}
        # The law tells of its limits only where the shell does not know them.
        value = STATUS_BITS["sensor_fault" if i in self.limited else "at_low_limit"].value
        while value <= 2 * STATUS_BITS["at_rate_limit"].value:
            named[f"word_by_{value}_{i}"] = word / float(value)
            named[f"bits_from_{value}_{i}"] = bits_from(word, value)
            value *= 2
        return named


def _called(name: str, what: str) -> str:
    """Return the name of a state that a scan goes on from: last_output_used_1."""
    stem, _, number = name.rpartition("_")
    return f"{stem}_{what}_{number}" if stem and number.isdigit() else f"{name}_{what}"


def _any(conditions: list[ca.SX]) -> ca.SX:
    return any_of(conditions) if conditions else ca.SX(0)


def _numbers(needed: Sequence[Diagnosis], followed: Sequence[RampedValue]) -> list[ca.SX]:
    return [*(sensor.number for sensor in needed), *(setpoint.number for setpoint in followed)]
