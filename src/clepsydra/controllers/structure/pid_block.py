"""One PID loop of a control scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.handover import Applied, Asked, Limits
from clepsydra.controllers.blocks.validity import is_number, is_time_step, value_or_zero
from clepsydra.controllers.pid_form import PidForm
from clepsydra.controllers.pid_parameters import pid_parameters, remembered
from clepsydra.controllers.structure.block import Closed, Opened
from clepsydra.controllers.structure.pid_terms import LoopSignals, pid_terms
from clepsydra.controllers.structure.setpoint import (
    Setpoint,
    chosen_setpoint,
    operator_setpoint,
    ramped,
)
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class PidBlock:
    """A PID loop: it measures one signal and moves an output, or another loop's setpoint.

    Parameters
    ----------
    name : str
        What other blocks call it.
    number : int
        k, from 1: the last part of the names of its parameters.
    form : PidForm
    measurement : Signal
        The process measurement.
    measured : int
        j of measurement_j.
    moved : Signal
        What it moves; lends unit and range.
    setpoint : int or str
        j of setpoint_j, which the operator gives, or the port of the block that gives it (the
        outer loop of a cascade).
    direct : int or None
        i, if it moves output i and nothing stands between.

    Examples
    --------
    >>> block = PidBlock("level", 1, PidForm(), Signal("level", "m"), 1, Signal("pump", "V"), 1, 1)
    >>> [signal.name for signal in block.state()]
    ['integral_1', 'last_proportional_gain_1', 'last_setpoint_weight_1']
    """

    name: str
    number: int
    form: PidForm
    measurement: Signal
    measured: int
    moved: Signal
    setpoint: int | str
    direct: int | None

    @property
    def sources(self) -> tuple[str, ...]:
        """The block that gives the setpoint, if one does."""
        return (self.setpoint,) if isinstance(self.setpoint, str) else ()

    @property
    def ports(self) -> tuple[str, ...]:
        """Its output."""
        return (self.name,)

    @property
    def _chooses(self) -> bool:
        return self.form.remote_setpoint or isinstance(self.setpoint, str)

    def _named(self, what: str) -> str:
        return f"{what}_{self.number}"

    def parameters(self) -> list[Signal]:
        """Settings of the loop; of an inner one also the limits of its setpoint."""
        found = pid_parameters(self.number, self.form, self.measurement, self.moved)
        if isinstance(self.setpoint, str):
            low, high = signals.limit_parameters(self.number, self.measurement)
            found += [
                signals.like_parameter(low, self._named("setpoint_low_limit")),
                signals.like_parameter(high, self._named("setpoint_high_limit")),
            ]
        return found

    def state(self) -> list[Signal]:
        """Integral, and what it remembers of the last sample."""
        y, name = self.measurement, self._named
        found = []
        if self.form.algorithm == "velocity":
            found += [
                signals.like(y, name("last_setpoint"), f"setpoint of {y.name} in the last sample"),
                signals.like(y, name("last_measurement"), f"{y.name} in the last sample"),
            ]
            if self.form.has_derivative:
                rate = signals.ratio_of_units(y.unit, "s")
                found.append(Signal(name("last_derivative"), rate))
        else:
            found.append(signals.integral_state(self.number, self.moved))
        if self.form.has_derivative:
            found.append(
                signals.like(y, name("filtered_signal"), "what is differentiated, filtered")
            )
        if self._chooses or self.form.setpoint_ramp:
            found.append(
                signals.like(y, name("working_setpoint"), f"setpoint that {y.name} follows")
            )
        if self._chooses:
            found.append(signals.setpoint_source(name("last_setpoint_source"), y))
        if self.direct is None:
            found.append(
                signals.like(self.moved, name("last_applied"), "what was applied of its output")
            )
        known = {parameter.name: parameter for parameter in self.parameters()}
        return found + [
            signals.like_parameter(known[parameter], f"last_{parameter}")
            for parameter in remembered(self.number, self.form)
        ]

    def inputs(self) -> list[Signal]:
        """Where the setpoint may be chosen: the other setpoint and the choice."""
        y, name = self.measurement, self._named
        if isinstance(self.setpoint, str):
            other = signals.like(y, name("local_setpoint"), f"local setpoint of {y.name}")
            return [other, signals.setpoint_source(name("setpoint_source"), y, remote=True)]
        if self.form.remote_setpoint:
            other = signals.like(y, name("remote_setpoint"), f"remote setpoint of {y.name}")
            return [other, signals.setpoint_source(name("setpoint_source"), y)]
        return []

    def outputs(self) -> list[Signal]:
        """None: it moves other blocks."""
        return []

    def limits(self, symbols: Symbols, after: Sequence[Limits]) -> tuple[Limits, ...]:
        """Those of its setpoint, if another block gives it."""
        if not isinstance(self.setpoint, str):
            return ()
        names = self._named("setpoint_low_limit"), self._named("setpoint_high_limit")
        return (Limits(*(symbols[name] for name in names)),)

    def open(self, symbols: Symbols, asked: Sequence[Asked], limits: Sequence[Limits]) -> Opened:
        """Compute what it asks for, and keep how its memory goes on."""
        name = self._named
        time_step_good = is_time_step(symbols["time_step"])
        time_step = ca.if_else(time_step_good, symbols["time_step"], 1)
        raw = symbols[f"measurement_{self.measured}"]
        valid, sound = is_number(raw), symbols[f"sensor_{self.measured}"]
        setpoint = self._chosen(symbols, asked)
        value = setpoint.value
        if self.form.setpoint_ramp:
            working = symbols[name("working_setpoint")]
            value = ramped(value, working, symbols[name("setpoint_ramp")], time_step)
        # A chosen setpoint that fails is held, and the loop goes on; an only one is not there.
        needed = [valid] if self._chooses else [setpoint.valid, valid]
        given = needed[0] if len(needed) == 1 else ca.logic_and(*needed)
        known = ca.logic_and(given, sound)
        terms = pid_terms(
            self.form,
            self.number,
            symbols,
            LoopSignals(
                setpoint=value,
                measurement=value_or_zero(raw, valid),
                known=known,
                switched=setpoint.switched,
                last_applied=self._last_applied(symbols),
                time_step=time_step,
                time_step_good=time_step_good,
            ),
            limits[0],
        )
        numbers = ca.logic_and(setpoint.valid, valid)
        sensors = ca.logic_and(sound, asked[0].sensors) if asked else sound
        # What cannot be computed asks for what stands.
        usable = ca.logic_and(known, time_step_good)
        value_asked = Asked(terms.unlimited, usable, numbers, sensors)
        named = terms.named | {
            name("setpoint_is_number"): setpoint.valid,
            name("measurement_is_number"): valid,
            name("signals_known"): known,
        }

        def close(applied: Sequence[Applied]) -> Closed:
            (result,) = applied
            state = terms.next_state(result)
            if self.direct is None:
                state[name("last_applied")] = ca.if_else(
                    is_number(result.value), result.value, symbols[name("last_applied")]
                )
            if self._chooses or self.form.setpoint_ramp:
                state[name("working_setpoint")] = self._working(
                    symbols, value, terms.measurement, known, result
                )
            if self._chooses:
                last = symbols[name("last_setpoint_source")]
                heard = ca.logic_and(known, ca.logic_or(result.in_force, result.follows))
                state[name("last_setpoint_source")] = ca.if_else(heard, self._source(symbols), last)
            told = (
                self._told(
                    symbols, terms.measurement, value, setpoint, known, terms.unlimited, result
                ),
            )
            return Closed(state, {}, told if isinstance(self.setpoint, str) else (), named)

        return Opened((value_asked,), close)

    def _last_applied(self, symbols: Symbols) -> ca.SX:
        if self.direct is not None:
            return symbols[f"last_output_{self.direct}"]
        return symbols[self._named("last_applied")]

    def _source(self, symbols: Symbols) -> ca.SX:
        """Return the source of the setpoint; what stands for none leaves the last one."""
        source = symbols[self._named("setpoint_source")]
        last = symbols[self._named("last_setpoint_source")]
        # The choices as numbers of their own: whatever the input holds, the result is one of them.
        return ca.if_else(source == 1, 1, ca.if_else(source == 0, 0, last))

    def _chosen(self, symbols: Symbols, asked: Sequence[Asked]) -> Setpoint:
        name = self._named
        if not self._chooses:
            return operator_setpoint(symbols[f"setpoint_{self.setpoint}"])
        if isinstance(self.setpoint, str):
            local, (remote,) = symbols[name("local_setpoint")], asked
            low, high = symbols[name("setpoint_low_limit")], symbols[name("setpoint_high_limit")]
            held = ca.fmin(high, ca.fmax(low, remote.value))
            remote = Asked(
                held,
                ca.logic_and(remote.usable, is_number(remote.value)),
                remote.numbers,
                remote.sensors,
            )
        else:
            local, given = symbols[f"setpoint_{self.setpoint}"], symbols[name("remote_setpoint")]
            true = ca.SX(1)
            remote = Asked(given, is_number(given), is_number(given), true)
        return chosen_setpoint(
            local,
            remote,
            self._source(symbols),
            symbols[name("last_setpoint_source")],
            symbols[name("working_setpoint")],
        )

    def _working(
        self, symbols: Symbols, value: ca.SX, measurement: ca.SX, known: ca.SX, applied: Applied
    ) -> ca.SX:
        """Return the setpoint to go on from; a ramp starts at the measurement."""
        if not self.form.setpoint_ramp:
            return value
        working = symbols[self._named("working_setpoint")]
        elsewhere = ca.if_else(ca.logic_and(applied.follows, known), measurement, working)
        return ca.if_else(applied.in_force, value, elsewhere)

    def _told(
        self,
        symbols: Symbols,
        measurement: ca.SX,
        value: ca.SX,
        setpoint: Setpoint,
        known: ca.SX,
        unlimited: ca.SX,
        applied: Applied,
    ) -> Applied:
        """Tell the outer loop which setpoint it got.

        Where this loop cannot follow, at a limit or in another mode, that is its measurement
        (external reset).
        """
        if not isinstance(self.setpoint, str):
            return applied
        remote = ca.logic_and(setpoint.remote, applied.in_force)
        got = ca.if_else(applied.value == unlimited, value, measurement)
        local = symbols[self._named("local_setpoint")]
        stands = ca.logic_and(applied.in_force, is_number(local))
        elsewhere = ca.if_else(stands, value_or_zero(local, is_number(local)), measurement)
        usable = ca.logic_or(stands, known)
        follows = ca.logic_and(
            ca.logic_or(applied.in_force, applied.follows),
            ca.logic_and(ca.logic_not(remote), usable),
        )
        return Applied(ca.if_else(remote, got, elsewhere), remote, follows)
