"""One scan of the plant shell: its blocks, wired around that of the law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.validity import any_of
from clepsydra.controllers.plant_shell.dependence import needed_by_outputs
from clepsydra.controllers.plant_shell.law_block import LawBlock
from clepsydra.controllers.plant_shell.members import Members
from clepsydra.controllers.plant_shell.output_end import OutputEnd
from clepsydra.controllers.plant_shell.scan import Scan
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
        Of the law, and what the shell adds but for those of `START`.
    initial : mapping
        State name to initial value.

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> ShellStep(multiloop_pid_law(2), Members((), (), (), {}, {}, 1, {}, ()), [], {}).sensors
    [(1,), (2,)]
    """

    def __init__(
        self,
        law: StepLaw,
        members: Members,
        state: Sequence[Signal | DelayRing],
        initial: Mapping[str, float],
    ) -> None:
        self.members, self.state, self.initial = members, state, initial
        count = sum(signal.name.startswith("manipulated_") for signal in law.outputs)
        self.remembered = {entry.name for entry in law.state}
        self.law = LawBlock(law, count, initial)
        self.sensors = needed_by_outputs(law, count, ("measurement", "sensor"))
        # A setpoint that stands fixed in the law is no business of the shell.
        ramped = {setpoint.number for setpoint in members.setpoints}
        self.setpoints = [
            tuple(j for j in needed if j in ramped)
            for needed in needed_by_outputs(law, count, ("setpoint",))
        ]

    def equations(self, symbols: Symbols) -> Equations:
        """Write one scan: judge, command, limit, let the law compute, and tell."""
        scan = Scan(symbols, self.state, self.initial)
        sensors = [sensor.checked(scan) for sensor in self.members.sensors]
        needed = [[sensors[j - 1] for j in numbers] for numbers in self.sensors]
        commands = [
            output.commanded(scan, own)
            for output, own in zip(self.members.outputs, needed, strict=True)
        ]
        setpoints = self._ramped(scan, sensors, commands)
        ends = [
            OutputEnd(scan, output, command, rated=output.number in self.members.rates)
            for output, command in zip(self.members.outputs, commands, strict=True)
        ]
        given = dict(symbols)
        for j, sensor in enumerate(sensors, start=1):
            given |= {f"measurement_{j}": sensor["measured"], f"sensor_{j}": sensor["good"]}
        for j, setpoint in enumerate(setpoints, start=1):
            given[f"setpoint_{j}"] = setpoint["setpoint_used"]
        for end in ends:
            given |= end.given
        found = self.law.computed(scan, given)
        told: dict[str, ca.SX] = {}
        named = dict(found.intermediates)
        for i, end in enumerate(ends, start=1):
            output = end.stands(found.outputs[f"manipulated_{i}"])
            followed = [setpoints[j - 1] for j in self.setpoints[i - 1]]
            bits = self.law.bits(found.outputs, i)
            told[f"manipulated_{i}"] = output
            told[f"status_{i}"] = end.status(output, bits, needed[i - 1], followed)
            if f"last_output_{i}" not in self.remembered:
                scan.next_state[f"last_output_{i}"] = output
            named |= end.named
        told["watchdog"] = scan["watchdog"]
        return Equations(scan.next_state, told, named)

    def _ramped(
        self, scan: Scan, sensors: Sequence[Symbols], commands: Sequence[Symbols]
    ) -> list[dict[str, ca.SX]]:
        found = []
        for setpoint in self.members.setpoints:
            users = [
                command
                for command, numbers in zip(commands, self.setpoints, strict=True)
                if setpoint.number in numbers
            ] or commands
            in_force = any_of([user["in_force"] for user in users])
            held = any_of(
                [ca.logic_and(user["in_force"], ca.logic_not(user["good"])) for user in users]
            )
            place = setpoint.measurement
            measured = None if place is None else sensors[place - 1]
            found.append(setpoint.ramped(scan, measured, in_force, held))
        return found
