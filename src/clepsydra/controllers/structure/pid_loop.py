"""What a PID loop computes, whatever it measures and moves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

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
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Setpoint:
    """The setpoint of a loop in this sample.

    Parameters
    ----------
    value : casadi.SX
        Always a number.
    valid : casadi.SX
        Whether the chosen source gave one.
    remote : casadi.SX
        Whether another block or the host computer gives it.
    switched : casadi.SX
        Whether the source changed since the last sample.
    """

    value: ca.SX
    valid: ca.SX
    remote: ca.SX
    switched: ca.SX


def operator_setpoint(raw: ca.SX) -> Setpoint:
    """Return the one setpoint of a simple loop."""
    valid = is_number(raw)
    return Setpoint(value_or_zero(raw, valid), valid, ca.SX(0), ca.SX(0))


def chosen_setpoint(
    local: ca.SX, remote: Asked, source: ca.SX, last_source: ca.SX, working: ca.SX
) -> Setpoint:
    """Return the setpoint of the chosen source; while that fails, the last one.

    `local`: what the operator gives; `remote`: what another block or the host computer gives;
    `source`, `last_source`: 0 local, 1 remote; now and in the last sample; `working`: the setpoint
    of the last sample.
    """
    is_remote = source == 1
    value = ca.if_else(is_remote, remote.asked, local)
    valid = ca.if_else(
        is_remote, ca.logic_and(remote.usable, is_number(remote.asked)), is_number(local)
    )
    return Setpoint(ca.if_else(valid, value, working), valid, is_remote, source != last_source)


def ramped(value: ca.SX, working: ca.SX, largest_rate: ca.SX, time_step: ca.SX) -> ca.SX:
    """Return a setpoint that moves from the last one no faster than its largest rate.

    `value`, `working`: the setpoint asked for, and that of the last sample [measurement unit];
    `largest_rate` [measurement unit / s]; `time_step` [s].

    Examples
    --------
    >>> float(ramped(ca.DM(5.0), ca.DM(3.0), ca.DM(0.5), ca.DM(2.0)))
    4.0
    """
    step = ca.fmax(largest_rate, 0) * time_step  # a rate below zero would turn the limits round
    return limit(value, working - step, working + step)


_MEASUREMENT, _OUTPUT = Signal("measurement"), Signal("output")


@dataclass(frozen=True)
class PidLoop:
    """A PID loop in one of its forms.

    Parameters
    ----------
    inner : bool
        Whether another block gives the setpoint (the outer loop of a cascade).
    direct : bool
        Whether it moves an output and nothing stands between.
    """

    form: PidForm
    inner: bool = False
    direct: bool = True

    @property
    def chooses(self) -> bool:
        """Whether its setpoint has two sources."""
        return self.form.remote_setpoint or self.inner

    def parameters(self, owner: str, measurement: Signal, moved: Signal) -> list[Signal]:
        """Return its parameters for two signals; of an inner loop also the setpoint's limits."""
        named = [keys.PARAMETERS[name] for name in self.form.parameters]
        found = [key.of(owner, measurement=measurement, output=moved) for key in named]
        if self.inner:
            for end in signals.limit_parameters(measurement):
                name = f"setpoint_{end.part}"
                found.append(replace(end, name=path(owner, name) if owner else name))
        return found

    def state(self, owner: str, measurement: Signal, moved: Signal) -> list[Signal]:
        """Return what it remembers, for two signals."""
        found = [key.of(owner, measurement=measurement, output=moved) for key in self._kept()]
        known = {each.part: each for each in self.parameters(owner, measurement, moved)}
        for name in self.form.remembered:
            last = f"last_{name}"
            found.append(replace(known[name], name=path(owner, last) if owner else last))
        return found

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

    def inputs(self, owner: str, measurement: Signal) -> list[Signal]:
        """Return the other setpoint and the choice, where there is one."""
        if not self.chooses:
            return []
        other = keys.LOCAL_SETPOINT if self.inner else keys.REMOTE_SETPOINT
        source = keys.SETPOINT_SOURCE.of(owner, float(self.inner), measurement=measurement)
        return [other.of(owner, measurement=measurement), source]

    @property
    def ports(self) -> tuple[Signal, ...]:
        """What it computes with, but for its state and the time step."""
        given = () if self.inner else (SP,)
        own = [*self.inputs("", _MEASUREMENT), *self.parameters("", _MEASUREMENT, _OUTPUT)]
        return (*given, PV, GOOD, *(each.port for each in own))

    @property
    def memory(self) -> tuple[Signal, ...]:
        """What it remembers, as the state of a block."""
        return tuple(each.port for each in self.state("", _MEASUREMENT, _OUTPUT))

    def faceplate(self, owner: str, measurement: Signal, moved: Signal) -> list[Signal]:
        """Return what an operator sees of it, the members of a structure."""
        shown, record = keys.FACEPLATE, "faceplate"
        if self.form.algorithm != "velocity":
            shown, record = (*shown, *keys.TERMS), "faceplate_pi"
            if self.form.has_derivative:
                shown, record = (*shown, keys.D_PART), "faceplate_pid"
        found = (key.of(owner, measurement=measurement, output=moved) for key in shown)
        return [replace(each, record=record) for each in found]

    @property
    def results(self) -> tuple[Signal, ...]:
        """What its block tells an operator."""
        return tuple(each.port for each in self.faceplate("", _MEASUREMENT, _OUTPUT))

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
            value = ramped(value, s["working_setpoint"], s["setpoint_ramp"], time_step)
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
            heard = ca.logic_and(s["signals_known"], ca.logic_or(applied.in_force, applied.follows))
            state["last_setpoint_source"] = ca.if_else(heard, _source(s), last)
        return state, self._got(s, applied) if self.inner else None, named

    def shows(self, s: Symbols, applied: Applied) -> dict[str, ca.SX]:
        """Return the values of `results`; s as for `told`."""
        seen = {
            "pv": s["pv"],
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
            return operator_setpoint(s["sp"])
        if remote is not None:
            local = s["local_setpoint"]
            held = ca.fmin(s["setpoint_high_limit"], ca.fmax(s["setpoint_low_limit"], remote.asked))
            usable = ca.logic_and(remote.usable, is_number(remote.asked))
            remote = Asked(held, usable, remote.numbers, remote.sensors)
        else:
            local, given = s["sp"], s["remote_setpoint"]
            remote = Asked(given, is_number(given), is_number(given), ca.SX(1))
        return chosen_setpoint(
            local, remote, _source(s), s["last_setpoint_source"], s["working_setpoint"]
        )

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
