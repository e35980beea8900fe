"""What a PID loop computes, and the signals that it has."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import casadi as ca

from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, path
from clepsydra.controllers import pid_keys as keys
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.anti_windup import integral_words
from clepsydra.controllers.blocks.pid import PID_WORDS, pid_state, pid_terms
from clepsydra.controllers.blocks.ports import GOOD, PV, SP, Applied, Asked
from clepsydra.controllers.blocks.validity import is_number, limit, time_step_of, value_or_zero
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.structure.block import PlainBlock
from clepsydra.program.step_law import Symbols


class Setpoint(NamedTuple):
    """The setpoint of a loop in this sample, always a number, and whether its source gave one.

    It is remote where another block or the host computer gives it, and switched where the source
    changed since the last sample.
    """

    value: ca.SX
    valid: ca.SX
    remote: ca.SX
    switched: ca.SX


@dataclass(frozen=True)
class PidLoop(PlainBlock):
    """A PID loop: it measures one signal and moves an output, or another loop's setpoint.

    `name`: what other blocks call it; `owner`: what its parameters and its state belong to;
    `measurement`: the process measurement; `moved`: what it moves; lends unit and range;
    `setpoint`: the law's input for it, or the port of the block that gives it; `inner`: whether
    another block gives the setpoint (the outer loop of a cascade); `direct`: whether it moves an
    output and nothing stands between.
    """

    name: str
    owner: str
    form: PidForm
    measurement: Signal
    moved: Signal
    setpoint: str
    inner: bool = False
    direct: bool = True

    @property
    def kind(self) -> Self:
        """A loop of its kind without an owner, whose signals are the ports of its blocks."""
        measurement, moved = Signal("measurement"), Signal("output")
        return replace(self, name="", owner="", setpoint="", measurement=measurement, moved=moved)

    @property
    def sources(self) -> tuple[str, ...]:
        """The block that gives the setpoint, if one does."""
        return (self.setpoint,) if self.inner else ()

    @property
    def chooses(self) -> bool:
        """Whether its setpoint has two sources."""
        return self.form.remote_setpoint or self.inner

    def _own(self, keys: Iterable[Key]) -> list[Signal]:
        roles = {"measurement": self.measurement, "output": self.moved}
        return [key.of(self.owner, **roles) for key in keys]

    def _renamed(self, signal: Signal, name: str) -> Signal:
        return replace(signal, name=path(self.owner, name) if self.owner else name)

    def parameters(self) -> list[Signal]:
        """Settings of the loop; of an inner one also the limits of its setpoint."""
        found = self._own(keys.PARAMETERS[name] for name in self.form.parameters)
        ends = signals.limit_parameters(self.measurement) if self.inner else []
        ends = [replace(end, below=end.below and f"setpoint_{end.below}") for end in ends]
        return found + [self._renamed(end, f"setpoint_{end.part}") for end in ends]

    def state(self) -> list[Signal]:
        """Integral, and what it remembers of the last sample."""
        known = {each.part: each for each in self.parameters()}
        last = [self._renamed(known[name], f"last_{name}") for name in self.form.remembered]
        return self._own(self._kept()) + last

    def _kept(self) -> Iterator[Key]:
        form = self.form
        if form.algorithm == "velocity":
            yield from (keys.LAST_SETPOINT, keys.LAST_MEASUREMENT)
            if form.has_derivative:
                yield keys.LAST_DERIVATIVE
        else:
            yield signals.INTEGRAL
        if form.has_derivative:
            yield keys.FILTERED_SIGNAL
        if self.chooses or form.setpoint_ramp:
            yield keys.WORKING_SETPOINT
        if self.chooses:
            yield keys.LAST_SETPOINT_SOURCE
        if not self.direct:
            yield keys.LAST_APPLIED

    def inputs(self) -> list[Signal]:
        """Where the setpoint may be chosen: the other setpoint and the choice."""
        if not self.chooses:
            return []
        (other,) = self._own([keys.LOCAL_SETPOINT if self.inner else keys.REMOTE_SETPOINT])
        source = keys.SETPOINT_SOURCE
        return [other, source.of(self.owner, float(self.inner), measurement=self.measurement)]

    def faceplate(self) -> list[Signal]:
        """What an operator sees of the loop, the members of a structure."""
        shown, record = keys.FACEPLATE, "faceplate"
        if self.form.algorithm != "velocity":
            shown, record = (*shown, *keys.TERMS), "faceplate_pi"
            if self.form.has_derivative:
                shown, record = (*shown, keys.D_PART), "faceplate_pid"
        return [replace(each, record=record) for each in self._own(shown)]

    @property
    def takes(self) -> tuple[Signal, ...]:
        """What its block computes with, but for its state and the time step."""
        given = () if self.inner else (SP,)
        return (*given, PV, GOOD, *(each.port for each in (*self.inputs(), *self.parameters())))

    @property
    def memory(self) -> tuple[Signal, ...]:
        """What it remembers, as the state of a block."""
        return tuple(each.port for each in self.state())

    @property
    def results(self) -> tuple[Signal, ...]:
        """What its block tells an operator."""
        return tuple(each.port for each in self.faceplate())

    @property
    def words(self) -> dict[str, str]:
        """What a reader is told above its steps."""
        return PID_WORDS | integral_words(self.form.winding)

    def asks(self, s: Symbols, remote: Asked | None) -> tuple[Asked, dict[str, ca.SX]]:
        """Return what the loop asks for, and what `told` needs to know of that.

        `s`: the signals of the loop by their names in it, and last_applied; `remote`: the setpoint
        that another block asks for.
        """
        time_step, time_step_good = time_step_of(s)
        sound, valid = s["good"], is_number(s["pv"])
        setpoint = self._chosen(s, remote)
        value = setpoint.value
        if self.form.setpoint_ramp:
            # A rate below zero would turn the limits round.
            step = ca.fmax(s["setpoint_ramp"], 0) * time_step
            working = s["working_setpoint"]
            value = limit(value, working - step, working + step)
        # A chosen setpoint that fails is held, and the loop goes on; an only one is not there.
        given = valid if self.chooses else ca.logic_and(setpoint.valid, valid)
        known = ca.logic_and(given, sound)
        used = {
            "setpoint_is_number": setpoint.valid,
            "measurement_is_number": valid,
            "signals_known": known,
            "setpoint_used": value,
            "measurement_used": value_or_zero(s["pv"], valid),
        }
        terms = pid_terms(self.form, {**s, **used, "switched": setpoint.switched})
        numbers = ca.logic_and(setpoint.valid, valid)
        sensors = sound if remote is None else ca.logic_and(sound, remote.sensors)
        # What cannot be computed asks for what stands.
        wish = Asked(terms["unlimited"], ca.logic_and(known, time_step_good), numbers, sensors)
        used["numbers"] = numbers
        return wish, {**terms, **used, "setpoint_is_remote": setpoint.remote}

    def told(
        self, s: Symbols, applied: Applied
    ) -> tuple[dict[str, ca.SX], Applied | None, dict[str, ca.SX]]:
        """Return the next state, which setpoint the block got that gives it, and names.

        `s`: the signals of the loop by their names in it, last_applied, the limits of what it
        moves, and what `asks` carried on.
        """
        state, named = pid_state(self.form, s, applied)
        if not self.direct:
            value = applied.applied
            state["last_applied"] = ca.if_else(is_number(value), value, s["last_applied"])
        if self.chooses or self.form.setpoint_ramp:
            state["working_setpoint"] = self._working(s, applied)
        if self.chooses:
            last = s["last_setpoint_source"]
            accepted = ca.logic_and(
                s["signals_known"], ca.logic_or(applied.in_force, applied.follows)
            )
            state["last_setpoint_source"] = ca.if_else(accepted, _source(s), last)
        return state, self._got(s, applied) if self.inner else None, named

    def shows(self, s: Symbols, applied: Applied) -> dict[str, ca.SX]:
        """Return the values of `results`; s as for `told`."""
        seen = {
            "pv": s["pv"],
            "pv_bad": ca.logic_not(ca.logic_and(s["good"], s["measurement_is_number"])),
            "sp": s["setpoint_used"],
            "error": s["error"],
            "op": applied.applied,
        }
        if self.form.algorithm != "velocity":
            seen |= {"p_part": s["proportional"], "i_part": s["integral_used"]}
        if "d_part" in s:
            seen |= {"p_part": s["p_part"], "d_part": s["d_part"]}
        return {signal.name: seen[signal.part] for signal in self.results}

    def _chosen(self, s: Symbols, remote: Asked | None) -> Setpoint:
        if not self.chooses:
            valid = is_number(s["sp"])
            return Setpoint(value_or_zero(s["sp"], valid), valid, ca.SX(0), ca.SX(0))
        if remote is not None:
            local = s["local_setpoint"]
            given = ca.fmin(
                s["setpoint_high_limit"], ca.fmax(s["setpoint_low_limit"], remote.asked)
            )
            usable = ca.logic_and(remote.usable, is_number(remote.asked))
        else:
            local, given = s["sp"], s["remote_setpoint"]
            usable = is_number(given)
        source, last = _source(s), s["last_setpoint_source"]
        is_remote = source == 1
        value = ca.if_else(is_remote, given, local)
        valid = ca.if_else(is_remote, ca.logic_and(usable, is_number(given)), is_number(local))
        # While the source that was chosen fails, the setpoint is the last one.
        held = ca.if_else(valid, value, s["working_setpoint"])
        return Setpoint(held, valid, is_remote, source != last)

    def _working(self, s: Symbols, applied: Applied) -> ca.SX:
        """Return the setpoint to go on from; a ramp starts at the measurement."""
        if not self.form.setpoint_ramp:
            return s["setpoint_used"]
        starts = ca.logic_and(applied.follows, s["signals_known"])
        elsewhere = ca.if_else(starts, s["measurement_used"], s["working_setpoint"])
        return ca.if_else(applied.in_force, s["setpoint_used"], elsewhere)

    def _got(self, s: Symbols, applied: Applied) -> Applied:
        """Return which setpoint it got, for the outer loop."""
        measurement, local = s["measurement_used"], s["local_setpoint"]
        remote = ca.logic_and(s["setpoint_is_remote"], applied.in_force)
        got = ca.if_else(applied.applied == s["unlimited"], s["setpoint_used"], measurement)
        stands = ca.logic_and(applied.in_force, is_number(local))
        elsewhere = ca.if_else(stands, value_or_zero(local, is_number(local)), measurement)
        usable = ca.logic_or(stands, s["signals_known"])
        follows = ca.logic_and(
            ca.logic_or(applied.in_force, applied.follows),
            ca.logic_and(ca.logic_not(remote), usable),
        )
        return Applied(ca.if_else(remote, got, elsewhere), remote, follows)


def _source(s: Symbols) -> ca.SX:
    """Return the source of the setpoint; what stands for none leaves the last one."""
    source, last = s["setpoint_source"], s["last_setpoint_source"]
    # The choices as numbers of their own: whatever the input holds, the result is one of them.
    return ca.if_else(source == 1, 1, ca.if_else(source == 0, 0, last))
