"""One scan of the plant shell: its blocks, wired around that of the law."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.alarms.interlock import OUTPUT_INTERLOCK
from clepsydra.controllers.blocks.ports import told as optional
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER, all_of, any_of, limit
from clepsydra.controllers.plant_shell.members import Members
from clepsydra.controllers.plant_shell.parameter_check import Judged, last_valid
from clepsydra.controllers.plant_shell.scan import scan_start
from clepsydra.controllers.plant_shell.signal_check import RAMP, signal_check
from clepsydra.controllers.plant_shell.status import (
    OF_LAW,
    OF_LIMITS,
    Rate,
    output_command,
    output_end,
)
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.program.block import Block
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import Equations, Symbols

#: What the law gets in the place of parts of an output, by the port of its command.
_OF_COMMAND = {
    "mode_used": "mode",
    "tracked": "tracking",
    "rate_used": "rate_limit",
    "lowest": "low_limit",
    "highest": "high_limit",
}


class ShellScan(Sample):
    """One scan: judge, command, limit, let the law compute, and tell.

    The law is a block whose parameters are inputs, and which tells its status bits one by one:
    what it names status_sensor_fault and the like of an output, on the way to its status word, or
    else the bits of the word. A law that only joins blocks needs none around them.

    `state`: of the law, and what the shell adds; `initial`: state name to initial value.
    """

    def __init__(
        self,
        members: Members,
        symbols: dict[str, ca.SX],
        state: Sequence[Signal | DelayRing],
        initial: Mapping[str, float],
    ) -> None:
        super().__init__(dict(symbols))
        self.members, self.law, self.initial = members, members.controller.law, initial
        self.delays = {entry.name: entry.length for entry in state if isinstance(entry, DelayRing)}
        #: The last output of each to the value that it fails safe to.
        self.safe: dict[str, ca.SX] = {}
        self._begin()
        for u in members.outputs:
            if u.name in members.interlocked:
                self._interlock(u)
        given = dict(self.symbols)
        # What the law integrates over is the time that the scan counts for.
        given["time_step"] = self["elapsed"]
        self.safe |= {path(u, "last_output"): self._fail_safe(u) for u in members.outputs}
        self.checks = {y.name: self._checked(y) for y in members.sensors}
        for y, check in self.checks.items():
            given |= {path(y, port): check[port] for port in ("pv", "good")}
        self.commands = {u.name: self._commanded(u) for u in members.outputs}
        self.ramps = {signal.name: self._ramped(signal, y) for signal, y in members.setpoints}
        given |= {path(name, "sp"): ramp["sp"] for name, ramp in self.ramps.items()}
        for name, command in self.commands.items():
            given |= {path(name, _OF_COMMAND[p]): command[p] for p in command if p in _OF_COMMAND}
        self.told = {u.name: self._bits(u) for u in members.outputs}
        block = self._law_block()
        if members.law_joins:
            found = block.equations(given | {e.name: self.state(e.name) for e in block.state})
            self.next_state |= found.next_state
            self.named |= found.intermediates
            results = found.outputs
        else:
            results = self.call(block, "law", **{s.name: given[s.name] for s in block.inputs})
        for u in members.outputs:
            self._end(u, results)
        for loop in members.loops:
            self._show(loop)
        self.outputs["watchdog"] = self["watchdog"]

    def _begin(self) -> None:
        """Judge the parameters, and how the scan begins."""
        start = scan_start(delays=bool(self.delays))
        longest = max(self.delays.values(), default=1)
        of_scan = {port.name for port in start.inputs}
        checks = self.members.checks
        # What a scan begins by is judged before it is known whether it begins anew.
        first = [check for check in checks if check.names <= of_scan]
        invalid = [self._judge(check, self.symbols.__getitem__) for check in first]
        kept = {entry.name: self.symbols[entry.name] for entry in start.state}
        begun = start("scan", {**self.symbols, "longest_delay": ca.SX(longest)}, kept)
        self.next_state |= begun.next_state
        self.symbols.update(begun.outputs)
        invalid += [self._judge(check, self.state) for check in checks if check not in first]
        self.symbols["invalid_parameter"] = any_of(invalid)
        self.named["invalid_parameter"] = self["invalid_parameter"]

    def state(self, name: str) -> ca.SX:
        """Return the value of a state that the scan goes on from: the initial one in a cold start.

        A ring cannot be overwritten in one scan: what is read of it counts as the initial value
        until it was written after the start. A warm start without kept state does not know where
        the actuators stand, so the last outputs are the fail-safe values.
        """
        anew = self["cold"]
        if name in self.delays:
            anew = self["scans_before"] < self.delays[name]
        kept = ca.if_else(anew, self.initial[name], self.symbols[name])
        if (safe := self.safe.get(name)) is not None:
            kept = ca.if_else(self["without_state"], safe, kept)
        return kept

    def _checked(self, y: Signal) -> dict[str, ca.SX]:
        block = signal_check(ranged=path(y, "range_low") in self.symbols)
        measurement, sensor = self.of(y, "pv", "good")
        name = path(y, "check")
        return self.call(block, name, y, measurement=measurement, sensor=sensor)

    def _judge(self, check: Judged, state: Callable[[str], ca.SX]) -> ca.SX:
        """Put parameters in force, or the last valid values; return whether they are not valid."""
        names = {own: last_valid(parameter).name for own, parameter in check.state.items()}
        lowest, highest = map(ca.SX, check.bounds)
        found = check.block(
            check.instance,
            {port: self[p.name] for port, p in check.parameters.items()}
            | {"lowest": lowest, "highest": highest},
            {own: state(name) for own, name in names.items()},
        )
        self.next_state |= {name: found.next_state[own] for own, name in names.items()}
        self.symbols.update((p.name, found.outputs[own]) for own, p in check.results.items())
        return found.outputs["invalid"]

    def _interlock(self, u: Signal) -> None:
        """Give an output that an alarm holds the mode and the tracking value for that."""
        found = self.call(OUTPUT_INTERLOCK, path(u, "interlock"), u)
        self.symbols[path(u, "mode")] = found["mode_given"]
        self.symbols[path(u, "tracking")] = found["tracking_given"]

    def _fail_safe(self, u: Signal) -> ca.SX:
        if not self.members.limited(u):
            return self[path(u, "fail_safe")]
        return limit(*self.of(u, "fail_safe", "low_limit", "high_limit"))

    def _commanded(self, u: Signal) -> dict[str, ca.SX]:
        """Return who moves an output, as the outputs of `output_command`."""
        rate: Rate = "none"
        if (rate_limit := path(u, "rate_limit")) in self.symbols:
            rate = "law" if rate_limit in self.members.own else "shell"
        sensors = [self.checks[name] for name in self.members.needed[u.name]]
        return self.call(
            output_command(
                limited=self.members.limited(u),
                rate=rate,
                interlocked=u.name in self.members.interlocked,
            ),
            path(u, "command"),
            u,
            good=all_of([ca.SX(1), *(sensor["good"] for sensor in sensors)]),
            failed=any_of([self["untimed"], *(sensor["failed"] for sensor in sensors)]),
            last_output=self.state(path(u, "last_output")),
        )

    def _ramped(self, signal: Signal, measurement: str | None) -> dict[str, ca.SX]:
        """Return a setpoint as the outputs of `RAMP`."""
        ends = {
            "range_low": ca.SX(max(signal.low, -LARGEST_NUMBER)),
            "range_high": ca.SX(min(signal.high, LARGEST_NUMBER)),
        }
        if measurement and path(measurement, "range_low") in self.symbols:
            ends = {end: self[path(measurement, end)] for end in ends}
        followed = self.members.followed
        users = [command for u, command in self.commands.items() if signal.name in followed[u]]
        users = users or [*self.commands.values()]
        given = {"pv": ca.SX(0), "good": ca.SX(0), "in_force": ca.SX(1)}
        if measurement:
            given = {port: self.checks[measurement][port] for port in ("pv", "good")}
            given["in_force"] = _any(users, "in_force")
        given |= ends | {"asked": self[path(signal, "sp")], "held": _any(users, "held")}
        return self.call(RAMP, path(signal, "ramp"), signal, **given)

    def _bits(self, u: Signal) -> tuple[str, ...]:
        """Return the status bits of an output that the law tells."""
        named = {signal.name for signal in self.law.intermediates}
        # A law that names its bits and has no rate limit is never at one.
        free = path(u, "status_at_rate_limit") in named
        free = free and path(u, "rate_limit") not in self.members.own
        limits = () if self.members.limited(u) else OF_LIMITS
        return (*OF_LAW, *(() if free else ("at_rate_limit",)), *limits)

    def _law_block(self) -> Block:
        law = self.law
        outputs = [signal for signal in law.outputs if signal.part != "status"]
        told = {path(u, f"status_{bit}"): (u, bit) for u, bits in self.told.items() for bit in bits}
        unread = {path(u, f"status_{bit}") for u in self.told for bit in STATUS_BITS}

        def equations(symbols: Symbols) -> Equations:
            assert law.equations is not None
            found = law.equations({**symbols})
            results = {signal.name: found.outputs[signal.name] for signal in outputs}
            for name, (u, bit) in told.items():
                read = found.intermediates.get(name)
                word = found.outputs[path(u, "status")]
                results[name] = _bit_of(word, bit) if read is None else read
            named = {name: x for name, x in found.intermediates.items() if name not in unread}
            return Equations(found.next_state, results, named)

        entries = [
            entry
            if isinstance(entry, DelayRing)
            else replace(entry, initial=self.initial[entry.name])
            for entry in law.state
        ]
        bits = (optional(name, STATUS_BITS[bit].meaning) for name, (_, bit) in told.items())
        return Block(
            law.name,
            (*law.inputs, *law.parameters),
            tuple(entries),
            (*outputs, *bits),
            equations,
            law.description,
        )

    def _end(self, u: Signal, law: Symbols) -> None:
        """Give an output and its status word."""
        sensors = [self.checks[name] for name in self.members.needed[u.name]]
        setpoints = [self.ramps[name] for name in self.members.followed[u.name]]
        told = {bit: law[path(u, f"status_{bit}")] for bit in self.told[u.name]}
        command = self.commands[u.name]
        ended = self.call(
            output_end(
                self.told[u.name],
                rated="lowest" in command,
                interlocked=u.name in self.members.interlocked,
            ),
            path(u, "end"),
            u,
            **command,
            **told,
            asked=law[path(u, "out")],
            invalid=_any([*sensors, *setpoints], "invalid"),
            uncertain=_any(sensors, "uncertain"),
            ramps=_any(setpoints, "ramps"),
            limited=_any(setpoints, "limited"),
        )
        self.outputs |= {path(u, part): value for part, value in ended.items()}
        # A law that does not remember what was applied leaves that to the shell.
        self.next_state.setdefault(path(u, "last_output"), ended["out"])

    def _show(self, loop: PidBlock) -> None:
        """Give what an operator sees of a loop; at an output that is what stands there."""
        shown = {signal.part: signal.name for signal in loop.faceplate()}
        self.outputs |= {name: self.named.pop(name) for name in shown.values()}
        if loop.direct:
            self.outputs[shown["op"]] = self.outputs[path(loop.moved, "out")]


def _bit_of(word: ca.SX, name: str) -> ca.SX:
    """Return whether a bit of a law's own status word is set."""
    value = float(STATUS_BITS[name].value)
    return ca.floor(word / value) - 2.0 * ca.floor(word / (2.0 * value)) == 1.0


def _any(parts: Sequence[Symbols], port: str) -> ca.SX:
    return any_of([ca.SX(0), *(part[port] for part in parts)])
