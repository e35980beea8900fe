"""The extended Kalman filter: an estimate by the process's own equations, and its covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.ports import called, port, truth
from clepsydra.controllers.blocks.sampled_matrices import (
    from_upper_triangle,
    sampled_expressions,
    upper_triangle,
)
from clepsydra.controllers.blocks.validity import all_of, is_number, is_time_step
from clepsydra.controllers.observers.measured_state import KnownState
from clepsydra.controllers.process_equations import NEARLY_EMPTY, ProcessEquations, model_parameter
from clepsydra.engine.runge_kutta import runge_kutta_step
from clepsydra.linear.process_symbols import Constant
from clepsydra.program.block import Block
from clepsydra.program.counted_loop import counted_loop
from clepsydra.program.step_law import Equations, Symbols

#: More states make a law that nobody can read or check on a plant.
MOST_STATES = 12


@dataclass(frozen=True, eq=False)
class ExtendedKalman:
    """x̂ and its covariance P, corrected by each measurement, and moved on by ẋ = f(x, u).

    In a sample, for one measurement after the other, with h_k and its slope H at the estimate
    so far and the variance V_k of its noise::

        s = H P Hᵀ + V_k,   x̂ ← x̂ + P Hᵀ (y_k − h_k(x̂))/s,   P ← P − P Hᵀ H P/s

    so that nothing but a positive number is divided by. Then x̂ moves on by the classical
    Runge-Kutta method under the inputs that were really given out, and

        P⁺ = Φ P Φᵀ + Δt/2 (S + Φ S Φᵀ),   Φ = e^(A(x̂) Δt),   S = B Q_u Bᵀ + E Q_d Eᵀ,

    with the intensities Q_u, Q_d of the noise of inputs and loads. The estimate stays within
    the ranges of the states; the slope of an outlet is taken at 2 % of the height at least,
    since it grows without bound as the tank empties. Where measurements fail, they do not
    correct, and P stops growing when an estimate is as unsure as the range of its state.

    Parameters
    ----------
    equations : ProcessEquations
    measurements : tuple of str [p]
        With the controlled outputs among them.
    loads : tuple of str
        Disturbances that make noise.
    substeps, doublings : int
        Steps of the Runge-Kutta method in a sample, and doublings of the power series of Φ.

    Raises
    ------
    InputError
        There are too many states, or a controlled output is not among the measurements.

    References
    ----------
    A. H. Jazwinski, Stochastic Processes and Filtering Theory, Academic Press 1970, chapter 8.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("three-tanks").linear)
    >>> observer = ExtendedKalman(equations, ("level_3",), (), 1, 0)
    >>> [signal.name for signal in observer.memory()][:4]
    ['tank_1.level.estimate', 'tank_2.level.estimate', 'tank_3.level.estimate', \
'tank_1.level.covariance.tank_1.level']
    """

    equations: ProcessEquations
    measurements: tuple[str, ...]
    loads: tuple[str, ...]
    substeps: int
    doublings: int

    def __post_init__(self) -> None:
        if len(self.equations.states) > MOST_STATES:
            raise InputError(
                "extended Kalman filter, states",
                len(self.equations.states),
                f"at most {MOST_STATES}",
                "use a linear Kalman filter",
            )
        missing = [name for name in self.equations.outputs if name not in self.measurements]
        if missing:
            raise InputError(
                "extended Kalman filter, measurements",
                list(self.measurements),
                "the controlled measurements among them",
                f"add {', '.join(missing)}",
            )

    @cached_property
    def _readings(self) -> list[ca.SX]:
        return [self.equations.reading(name) for name in self.measurements]

    @cached_property
    def _slopes(self) -> list[ca.SX]:
        return [ca.jacobian(reading, self.equations.state) for reading in self._readings]

    @cached_property
    def _linear(self) -> list[ca.SX]:
        """A, B and, where loads make noise, E."""
        found = [self.equations.A, self.equations.B]
        return [*found, self.equations.by_constant(self.loads)] if self.loads else found

    @property
    def constants(self) -> tuple[Constant, ...]:
        """Of everything that it computes with."""
        equations = self.equations
        expressions = [equations.rates, *self._readings, *self._slopes, *self._linear]
        return equations.used_in(expressions)

    def parameters(self) -> list[Signal]:
        """Return sensor_noise of measurements, input_noise of inputs and load_noise of loads."""
        process = self.equations.point.process
        found = []
        for name in self.measurements:
            y, words = process.signal(name), f"standard deviation of {name}"
            found.append(signals.size(path(name, "sensor_noise"), y, words))
        for what, names in (("input", self.equations.inputs), ("load", self.loads)):
            for name in names:
                unit = process.signal(name).unit
                unit = "s^0.5" if unit == "1" else f"{unit} s^0.5"
                words = f"white noise of {name}: what it adds up to in a second, root mean square"
                found.append(signals.size(path(name, f"{what}_noise"), unit, words))
        return found

    def memory(self) -> list[Signal]:
        """Return estimate of each state, and covariance on and above the diagonal."""
        found = self.equations.signals_of_states()
        estimates = [
            signals.like(signal, path(signal, "estimate"), f"expected {signal.name}")
            for signal in found
        ]
        covariances = [
            Signal(
                effect(first, "covariance", second),
                _product(first.unit, second.unit),
                description=f"covariance of {first.name} and {second.name} as expected",
            )
            for j, first in enumerate(found)
            for second in found[j:]
        ]
        return [*estimates, *covariances]

    def known(self, symbols: Symbols, measured: Sequence[ca.SX], usable: ca.SX) -> KnownState:
        """Return the estimate corrected by the measurements of this sample.

        It is the block kalman_correction, and what is expected in the next sample the block
        kalman_prediction, on one memory.
        """
        process, memory, n = self.equations.point.process, self.memory(), len(self.equations.states)
        values, surprises = (
            [replace(process.signal(name), name=path(name, part)) for name in self.measurements]
            for part in ("measured", "surprise")
        )
        corrected = [
            replace(entry, name=path(entry, "corrected"), description="with the measurements")
            for entry in memory
        ]
        moved = [
            replace(process.signal(name), name=path(name, "applied"))
            for name in self.equations.inputs
        ]
        noises = self.parameters()
        correction = Block(
            "kalman_correction",
            (
                *map(port, values),
                truth("usable", "the measurements are numbers from sound sensors"),
                *map(port, memory),
                *self._models([*self._readings, *self._slopes]),
                *noises[: len(values)],
            ),
            (),
            (*map(port, corrected), *map(port, surprises)),
            self._corrected,
            ("The estimate corrected by one measurement after the other.",),
        )
        prediction = Block(
            "kalman_prediction",
            (
                *map(port, corrected),
                *map(port, moved),
                Signal("time_step", "s"),
                *self._models([self.equations.rates, *self._linear]),
                *noises[len(values) :],
            ),
            tuple(memory),
            (),
            self._following,
            ("The estimate and its covariance expected in the next sample.",),
        )
        given = {port.name: value for port, value in zip(values, measured, strict=True)}
        found = called(correction, "kalman_correction", {**symbols, **given, "usable": usable})
        x = list(found.outputs.values())[:n]

        def following(applied: Sequence[ca.SX]) -> dict[str, ca.SX]:
            given = {port.name: value for port, value in zip(moved, applied, strict=True)}
            whole = {**symbols, **found.outputs, **given}
            return dict(called(prediction, "kalman_prediction", whole).next_state)

        named = {signal.name: found.outputs[signal.name] for signal in surprises}
        named |= {
            path(n, "state"): value for n, value in zip(self.equations.states, x, strict=True)
        }
        return KnownState(x, following, named)

    def _models(self, expressions: Sequence[ca.SX]) -> list[Signal]:
        return [model_parameter(each) for each in self.equations.used_in(expressions)]

    def _memory_in(self, s: Symbols, names: Sequence[str]) -> tuple[list[ca.SX], ca.SX]:
        """Return x and P."""
        n = len(self.equations.states)
        values = [s[name] for name in names]
        return values[:n], from_upper_triangle(values[n:], n)

    def _corrected(self, s: Symbols) -> Equations:
        x, P = self._memory_in(s, [entry.name for entry in self.memory()])
        n = len(x)
        nothing = [ca.SX(0)] * len(self.equations.inputs)
        found = {}
        for y, *shown in zip(self.measurements, self._readings, self._slopes, strict=True):
            reading, slope = self.equations.evaluated(shown, x, nothing, s)
            spread = P @ slope.T
            noise = s[path(y, "sensor_noise")]
            total = (slope @ spread)[0] + noise * noise
            sure = ca.logic_and(s["usable"], ca.logic_and(total > 0, is_number(total)))
            share = ca.densify(spread) / ca.if_else(sure, total, 1)
            surprise = ca.if_else(sure, s[path(y, "measured")] - reading, 0)
            found[path(y, "surprise")] = surprise
            corrected = [was + share[j] * surprise for j, was in enumerate(x)]
            x = self.equations.bounded(corrected)
            less = [
                P[i, j] - ca.if_else(sure, share[i] * spread[j], 0)
                for i in range(n)
                for j in range(i, n)
            ]
            P = from_upper_triangle(less, n)
        values = zip(self.memory(), [*x, *upper_triangle(P)], strict=True)
        return Equations({}, {path(e, "corrected"): value for e, value in values} | found)

    def _following(self, s: Symbols) -> Equations:
        """Return what is expected in the next sample."""
        x, P = self._memory_in(s, [path(entry, "corrected") for entry in self.memory()])
        applied = [s[path(name, "applied")] for name in self.equations.inputs]
        good = is_time_step(s["time_step"])
        time = ca.if_else(good, s["time_step"], 1)
        ends = self.equations.bounded(self._moved(s, x, time, applied))
        following = self._spread(s, x, P, time, applied)
        n = len(x)
        diagonal = [following[j, j] for j in range(n)]
        spans = [signal.span for signal in self.equations.signals_of_states()]
        # Never surer than not at all, nor less sure than of a state that may be anything.
        sound = [
            ca.logic_and(value >= 0, value <= min(span * span, 1e300))
            for value, span in zip(diagonal, spans, strict=True)
        ]
        entries = upper_triangle(following)
        moves = ca.logic_and(good, all_of([is_number(end) for end in ends]))
        spreads = ca.logic_and(moves, all_of([*sound, *map(is_number, entries)]))
        taken = [(moves, end) for end in ends] + [(spreads, entry) for entry in entries]
        return Equations(
            {
                entry.name: ca.if_else(*each, s[entry.name])
                for entry, each in zip(self.memory(), taken, strict=True)
            },
            {},
        )

    def _moved(
        self, symbols: Symbols, x: Sequence[ca.SX], time: ca.SX, applied: Sequence[ca.SX]
    ) -> list[ca.SX]:
        """Return the state after a sample, by steps of the classical Runge-Kutta method."""
        equations, n = self.equations, len(x)
        used = equations.used_in([equations.rates])
        given = [symbols[model_parameter(each).name] for each in used]
        state = ca.SX.sym("state", n)
        fixed = ca.SX.sym("fixed", len(applied) + len(given) + 1)
        moved, constants, step = ca.vertsplit(
            fixed, [0, len(applied), fixed.numel() - 1, fixed.numel()]
        )
        arguments = [equations.state, equations.moved, ca.vertcat(*(each.symbol for each in used))]
        rates = ca.Function("rates", arguments, [ca.densify(equations.rates)])
        end = runge_kutta_step(rates)(step, state, moved, constants)
        invariants = ca.vertcat(*applied, *given, time * (1.0 / self.substeps))
        body = ca.Function("runge_kutta_step", [ca.SX(0, 1), state, fixed], [end])
        if self.substeps == 1:
            return ca.vertsplit(body(ca.SX(0, 1), ca.vertcat(*x), invariants))
        ends = counted_loop(
            "prediction", self.substeps, body, carried=ca.vertcat(*x), invariants=invariants
        )
        return ca.vertsplit(ends)

    def _spread(
        self,
        symbols: Symbols,
        x: Sequence[ca.SX],
        P: ca.SX,
        time: ca.SX,
        applied: Sequence[ca.SX],
    ) -> ca.SX:
        """Return P of the next sample."""
        here = self.equations.bounded(x, NEARLY_EMPTY)
        A, B, *E = self.equations.evaluated(self._linear, here, applied, symbols)
        held = sampled_expressions(A, ca.SX(A.shape[0], 1), None, time, self.doublings).held
        intensity = _intensity(symbols, "input_noise", self.equations.inputs, B)
        if E:
            intensity = intensity + _intensity(symbols, "load_noise", self.loads, E[0])
        noise = (0.5 * time) * (intensity + held @ intensity @ held.T)
        return held @ P @ held.T + noise


def _intensity(symbols: Symbols, part: str, of: Sequence[str], acts: ca.SX) -> ca.SX:
    size = [symbols[path(name, part)] for name in of]
    scaled = acts @ ca.diag(ca.vertcat(*size))
    return scaled @ scaled.T


def _product(first: str, second: str) -> str:
    units = [f"({unit})" if "/" in unit else unit for unit in (first, second) if unit != "1"]
    if len(units) == 2 and first == second:
        return f"{units[0]}^2"
    return " ".join(units) or "1"
