"""One PID loop of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import casadi as ca

from clepsydra.base.signal import Signal, owned, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import ASKED, asked_ports
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.integral import applied_ports
from clepsydra.controllers.blocks.ports import as_parts, called, instance, parts_of
from clepsydra.controllers.blocks.validity import is_number, value_or_zero
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.pid_parameters import pid_parameters, remembered
from clepsydra.controllers.structure.block import Closed, Opened, WithoutSignals
from clepsydra.controllers.structure.loop_phases import phases
from clepsydra.controllers.structure.pid_terms import (
    LoopSignals,
    pid_state,
    pid_terms,
    time_step_of,
)
from clepsydra.controllers.structure.setpoint import (
    Setpoint,
    chosen_setpoint,
    operator_setpoint,
    ramped,
)
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class PidBlock(WithoutSignals):
    """A PID loop: it measures one signal and moves an output, or another loop's setpoint.

    Parameters
    ----------
    name : str
        What other blocks call it.
    owner : str
        What its parameters and its state belong to.
    form : PidForm
    measurement : Signal
        The process measurement.
    moved : Signal
        What it moves; lends unit and range.
    setpoint : str
        The law's input for it, or the port of the block that gives it.
    inner : bool
        Whether another block gives the setpoint (the outer loop of a cascade).
    direct : bool
        Whether it moves an output and nothing stands between.

    Examples
    --------
    >>> level, pump = Signal("level", "m"), Signal("pump", "V")
    >>> block = PidBlock("loop", "level", PidForm(), level, pump, "level.sp")
    >>> [signal.name for signal in block.state()]
    ['level.integral', 'level.last_proportional_gain', 'level.last_setpoint_weight']
    """

    name: str
    owner: str
    form: PidForm
    measurement: Signal
    moved: Signal
    setpoint: str
    inner: bool = False
    direct: bool = True

    @classmethod
    def of(cls, measurement: Signal, form: PidForm, moved: Signal, *, direct: bool = True) -> Self:
        """Return the loop of a measurement whose setpoint the operator gives."""
        name, setpoint = measurement.name, path(measurement, "sp")
        return cls(f"loop {name}", name, form, measurement, moved, setpoint, direct=direct)

    @property
    def sources(self) -> tuple[str, ...]:
        """The block that gives the setpoint, if one does."""
        return (self.setpoint,) if self.inner else ()

    @property
    def ports(self) -> tuple[str, ...]:
        """Its output."""
        return (self.name,)

    @property
    def _chooses(self) -> bool:
        return self.form.remote_setpoint or self.inner

    def parameters(self) -> list[Signal]:
        """Settings of the loop; of an inner one also the limits of its setpoint."""
        return owned(self.owner, self.own_parameters())

    def state(self) -> list[Signal]:
        """Integral, and what it remembers of the last sample."""
        return owned(self.owner, self.own_state())

    def inputs(self) -> list[Signal]:
        """Where the setpoint may be chosen: the other setpoint and the choice."""
        return owned(self.owner, self.own_inputs())

    def own_parameters(self) -> list[Signal]:
        """Return its parameters by the names that they have in the loop."""
        found = pid_parameters(self.form, self.measurement, self.moved)
        if self.inner:
            for end in signals.limit_parameters(self.measurement):
                found.append(signals.like_parameter(end, f"setpoint_{end.part}"))
        return found

    def own_state(self) -> list[Signal]:
        """Return its state by the names that it has in the loop."""
        y, form = self.measurement, self.form
        found = []
        if form.algorithm == "velocity":
            found += [
                signals.like(y, "last_setpoint", f"setpoint of {y.name} in the last sample"),
                signals.like(y, "last_measurement", f"{y.name} in the last sample"),
            ]
            if form.has_derivative:
                found.append(replace(signals.per(y, "s"), name="last_derivative"))
        else:
            found.append(signals.integral_of(self.moved))
        if form.has_derivative:
            found.append(signals.like(y, "filtered_signal", "what is differentiated, filtered"))
        if self._chooses or form.setpoint_ramp:
            found.append(signals.like(y, "working_setpoint", f"setpoint that {y.name} follows"))
        if self._chooses:
            found.append(signals.setpoint_source("last_setpoint_source", y))
        if not self.direct:
            found.append(signals.like(self.moved, "last_applied", "what was applied of its output"))
        known = {parameter.name: parameter for parameter in self.own_parameters()}
        return found + [
            signals.like_parameter(known[parameter], f"last_{parameter}")
            for parameter in remembered(form)
        ]

    def own_inputs(self) -> list[Signal]:
        """Return the other setpoint and the choice by the names that they have in the loop."""
        y = self.measurement
        if self.inner:
            other = signals.like(y, "local_setpoint", f"local setpoint of {y.name}")
            return [other, signals.setpoint_source("setpoint_source", y, remote=True)]
        if self.form.remote_setpoint:
            other = signals.like(y, "remote_setpoint", f"remote setpoint of {y.name}")
            return [other, signals.setpoint_source("setpoint_source", y)]
        return []

    def of_law(self, symbols: Symbols) -> dict[str, ca.SX]:
        """Return what a law has for the loop, by the names that it has in the loop."""
        own = [*self.own_parameters(), *self.own_state(), *self.own_inputs()]
        found = parts_of(self.owner, symbols, own)
        found["measurement"] = symbols[path(self.measurement, "pv")]
        found["sensor"] = symbols[path(self.measurement, "good")]
        if not self.inner:
            found["setpoint"] = symbols[self.setpoint]
        if self.direct:
            found["last_applied"] = symbols[path(self.moved, "last_output")]
        return {**found, "time_step": symbols["time_step"]}

    @property
    def generic(self) -> PidBlock:
        """The loop without anything of its instance."""
        y, u = Signal("measurement"), Signal("output")
        return replace(self, name="loop", owner="loop", measurement=y, moved=u, setpoint="setpoint")

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those of its setpoint, if another block gives it."""
        if not self.inner:
            return ()
        ends = (symbols[path(self.owner, f"setpoint_{end}_limit")] for end in ("low", "high"))
        return (Limits(*ends),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Compute what it asks for, and keep how its memory goes on."""
        asking, telling = phases(self.generic)
        own = self.of_law(symbols) | {"low_limit": limits[0].low, "high_limit": limits[0].high}
        for outer in asked:
            own |= {f"remote_{name}": value for name, value in asked_ports(outer).items()}
        name = instance(self.name)
        first = called(asking, path(name, "asks"), own)

        def close(applied: Sequence[Applied]) -> Closed:
            given = {**own, **first.outputs, **applied_ports(applied[0])}
            last = called(telling, path(name, "is_told"), given)
            got = tuple(last.outputs.values())
            return Closed(
                as_parts(self.owner, last.next_state),
                {},
                (Applied(*got),) if got else (),
                as_parts(self.owner, first.intermediates),
            )

        wish = Asked(*(first.outputs[signal.name] for signal in ASKED))
        return Opened((wish,), close)

    def asks(self, s: Symbols, remote: Asked | None) -> tuple[Asked, dict[str, ca.SX]]:
        """Return what the loop asks for, and what `told` needs to know of that.

        Parameters
        ----------
        s : mapping
            The signals of the loop by their names in it, and last_applied.
        remote : Asked or None
            The setpoint that another block asks for.
        """
        time_step, time_step_good = time_step_of(s)
        raw, sound = s["measurement"], s["sensor"]
        valid = is_number(raw)
        setpoint = self._chosen(s, remote)
        value = setpoint.value
        if self.form.setpoint_ramp:
            value = ramped(value, s["working_setpoint"], s["setpoint_ramp"], time_step)
        # A chosen setpoint that fails is held, and the loop goes on; an only one is not there.
        given = valid if self._chooses else ca.logic_and(setpoint.valid, valid)
        known = ca.logic_and(given, sound)
        measurement = value_or_zero(raw, valid)
        loop = LoopSignals(value, measurement, known, setpoint.switched, s["last_applied"])
        terms = pid_terms(self.form, s, loop)
        numbers = ca.logic_and(setpoint.valid, valid)
        sensors = sound if remote is None else ca.logic_and(sound, remote.sensors)
        # What cannot be computed asks for what stands.
        usable = ca.logic_and(known, time_step_good)
        carried = {
            **terms,
            "setpoint_is_number": setpoint.valid,
            "measurement_is_number": valid,
            "signals_known": known,
            "setpoint_used": value,
            "measurement_used": measurement,
            "setpoint_is_remote": setpoint.remote,
        }
        return Asked(terms["unlimited"], usable, numbers, sensors), carried

    def told(self, s: Symbols, applied: Applied) -> tuple[dict[str, ca.SX], Applied | None]:
        """Return the next state, and which setpoint the block got that gives it.

        Parameters
        ----------
        s : mapping
            The signals of the loop by their names in it, last_applied, the limits of what it
            moves, and what `asks` carried on.
        applied : Applied
        """
        state = pid_state(self.form, s, applied)
        if not self.direct:
            state["last_applied"] = ca.if_else(
                is_number(applied.value), applied.value, s["last_applied"]
            )
        if self._chooses or self.form.setpoint_ramp:
            state["working_setpoint"] = self._working(s, applied)
        if self._chooses:
            last = s["last_setpoint_source"]
            heard = ca.logic_and(s["signals_known"], ca.logic_or(applied.in_force, applied.follows))
            state["last_setpoint_source"] = ca.if_else(heard, self._source(s), last)
        return state, self._got(s, applied) if self.inner else None

    def _source(self, s: Symbols) -> ca.SX:
        """Return the source of the setpoint; what stands for none leaves the last one."""
        source, last = s["setpoint_source"], s["last_setpoint_source"]
        # The choices as numbers of their own: whatever the input holds, the result is one of them.
        return ca.if_else(source == 1, 1, ca.if_else(source == 0, 0, last))

    def _chosen(self, s: Symbols, remote: Asked | None) -> Setpoint:
        if not self._chooses:
            return operator_setpoint(s["setpoint"])
        if remote is not None:
            local = s["local_setpoint"]
            held = ca.fmin(s["setpoint_high_limit"], ca.fmax(s["setpoint_low_limit"], remote.value))
            usable = ca.logic_and(remote.usable, is_number(remote.value))
            remote = Asked(held, usable, remote.numbers, remote.sensors)
        else:
            local, given = s["setpoint"], s["remote_setpoint"]
            remote = Asked(given, is_number(given), is_number(given), ca.SX(1))
        return chosen_setpoint(
            local, remote, self._source(s), s["last_setpoint_source"], s["working_setpoint"]
        )

    def _working(self, s: Symbols, applied: Applied) -> ca.SX:
        """Return the setpoint to go on from; a ramp starts at the measurement."""
        if not self.form.setpoint_ramp:
            return s["setpoint_used"]
        starts = ca.logic_and(applied.follows, s["signals_known"])
        elsewhere = ca.if_else(starts, s["measurement_used"], s["working_setpoint"])
        return ca.if_else(applied.in_force, s["setpoint_used"], elsewhere)

    def _got(self, s: Symbols, applied: Applied) -> Applied:
        """Return which setpoint it got, for the outer loop.

        Where this loop cannot follow, at a limit or in another mode, that is its measurement
        (external reset).
        """
        measurement, local = s["measurement_used"], s["local_setpoint"]
        remote = ca.logic_and(s["setpoint_is_remote"], applied.in_force)
        got = ca.if_else(applied.value == s["unlimited"], s["setpoint_used"], measurement)
        stands = ca.logic_and(applied.in_force, is_number(local))
        elsewhere = ca.if_else(stands, value_or_zero(local, is_number(local)), measurement)
        usable = ca.logic_or(stands, s["signals_known"])
        follows = ca.logic_and(
            ca.logic_or(applied.in_force, applied.follows),
            ca.logic_and(ca.logic_not(remote), usable),
        )
        return Applied(ca.if_else(remote, got, elsewhere), remote, follows)
