"""One scan of the plant shell: its blocks, wired around that of the law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.ports import as_parts
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
    >>> law = multiloop_pid_law(["level_1", "level_2"], ["pump_1", "pump_2"])
    >>> ShellStep(law, Members((), (), (), {}, {}, 1, {}, ()), [], {}).sensors
    {'pump_1': ('level_1',), 'pump_2': ('level_2',)}
    """

    def __init__(
        self,
        law: StepLaw,
        members: Members,
        state: Sequence[Signal | DelayRing],
        initial: Mapping[str, float],
    ) -> None:
        self.members, self.state, self.initial = members, state, initial
        self.remembered = {entry.name for entry in law.state}
        self.law = LawBlock(law, initial)
        self.sensors = needed_by_outputs(law, ("pv", "good"))
        # A setpoint that stands fixed in the law is no business of the shell.
        ramped = {setpoint.signal.name for setpoint in members.setpoints}
        self.setpoints = {
            output: tuple(name for name in needed if name in ramped)
            for output, needed in needed_by_outputs(law, ("sp",)).items()
        }

    def equations(self, symbols: Symbols) -> Equations:
        """Write one scan: judge, command, limit, let the law compute, and tell."""
        scan = Scan(symbols, self.state, self.initial)
        sensors = {sensor.signal.name: sensor.checked(scan) for sensor in self.members.sensors}
        needed = {u: [sensors[name] for name in names] for u, names in self.sensors.items()}
        commands = {
            output.signal.name: output.commanded(scan, needed[output.signal.name])
            for output in self.members.outputs
        }
        setpoints = self._ramped(scan, sensors, commands)
        ends = {
            u: OutputEnd(scan, output, commands[u], rated=u in self.members.rates)
            for output in self.members.outputs
            for u in [output.signal.name]
        }
        given = dict(symbols)
        for name, sensor in sensors.items():
            given |= as_parts(name, {"pv": sensor["measured"], "good": sensor["good"]})
        for name, setpoint in setpoints.items():
            given[path(name, "sp")] = setpoint["setpoint_used"]
        for end in ends.values():
            given |= end.given
        found = self.law.computed(scan, given)
        told: dict[str, ca.SX] = {}
        named = dict(found.intermediates)
        for u, end in ends.items():
            output = end.stands(found.outputs[path(u, "out")])
            followed = [setpoints[name] for name in self.setpoints[u]]
            bits = self.law.bits(found.outputs, u)
            status = end.status(output, bits, needed[u], followed)
            told |= as_parts(u, {"out": output, "status": status})
            if (last := path(u, "last_output")) not in self.remembered:
                scan.next_state[last] = output
            named |= end.named
        told["watchdog"] = scan["watchdog"]
        return Equations(scan.next_state, told, named)

    def _ramped(
        self, scan: Scan, sensors: Mapping[str, Symbols], commands: Mapping[str, Symbols]
    ) -> dict[str, dict[str, ca.SX]]:
        found = {}
        for setpoint in self.members.setpoints:
            name = setpoint.signal.name
            users = [commands[u] for u, needed in self.setpoints.items() if name in needed]
            users = users or [*commands.values()]
            in_force = any_of([user["in_force"] for user in users])
            held = any_of(
                [ca.logic_and(user["in_force"], ca.logic_not(user["good"])) for user in users]
            )
            measured = None if setpoint.measurement is None else sensors[setpoint.measurement]
            found[name] = setpoint.ramped(scan, measured, in_force, held)
        return found
