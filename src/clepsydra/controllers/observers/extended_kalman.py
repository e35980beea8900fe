"""The extended Kalman filter: an estimate by the process's own equations, and its covariance."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, effect, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.matrix import column
from clepsydra.controllers.blocks.sample import Reading, Sample
from clepsydra.controllers.blocks.sampled_matrices import (
    from_upper_triangle,
    held_matrix,
    upper_triangle,
)
from clepsydra.controllers.blocks.validity import all_of, is_number, time_step_of
from clepsydra.controllers.observers.observer import ESTIMATE, Observer, Values
from clepsydra.controllers.observers.state_source import ProcessState
from clepsydra.controllers.process_model import evaluated, function_in, models_in
from clepsydra.engine.runge_kutta import runge_kutta
from clepsydra.linear.process_equations import NEARLY_EMPTY, ProcessEquations
from clepsydra.program.step_law import Symbols

#: More states make a law that nobody can read or check on a plant.
MOST_STATES = 12
_NOISES = "input_noise", "load_noise"


class ExtendedKalman(ProcessState, Observer):
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
    measurements : tuple of str [p]
        With the controlled outputs among them.
    loads : tuple of str
        Disturbances that make noise.
    substeps, doublings : int
        Steps of the Runge-Kutta method in a sample, and doublings of the power series of Φ.

    Raises InputError: there are too many states, or a controlled output is not among the
    measurements.

    References
    ----------
    A. H. Jazwinski, Stochastic Processes and Filtering Theory, Academic Press 1970, chapter 8.
    """

    _kind = "kalman"

    def __init__(
        self,
        equations: ProcessEquations,
        measurements: Sequence[str],
        loads: Sequence[str],
        substeps: int,
        doublings: int,
    ) -> None:
        if len(equations.states) > MOST_STATES:
            raise InputError(
                "extended Kalman filter, states",
                len(equations.states),
                f"at most {MOST_STATES}",
                "use a linear Kalman filter",
            )
        if missing := [name for name in equations.outputs if name not in measurements]:
            raise InputError(
                "extended Kalman filter, measurements",
                list(measurements),
                "the controlled measurements among them",
                f"add {', '.join(missing)}",
            )
        self.substeps, self.doublings = substeps, doublings
        readings = [equations.reading(name) for name in measurements]
        self._shown_by = [(h, ca.jacobian(h, equations.state)) for h in readings]
        # A, B and, where loads make noise, E.
        self._linear = [equations.A, equations.B]
        self._linear += [equations.by_constant(loads)] if loads else []
        shown = [each for pair in self._shown_by for each in pair]
        computed = [equations.rates, *shown, *self._linear]
        ProcessState.__init__(self, equations, measurements)
        self._noisy = self.manipulated, [equations.point.process.signal(name) for name in loads]
        model = [*models_in(equations, computed), *self._noises()]
        Observer.__init__(self, self.state(), self.measured, self.manipulated, model)

    def _noises(self) -> list[Signal]:
        found = [
            signals.size(path(y, "sensor_noise"), y, f"standard deviation of {y.name}")
            for y in self.measured
        ]
        words = "what it adds up to in a second, root mean square"
        for part, of in zip(_NOISES, self._noisy, strict=True):
            for each in of:
                unit = "s^0.5" if each.unit == "1" else f"{each.unit} s^0.5"
                name = path(each, part)
                found.append(signals.size(name, unit, f"white noise of {each.name}: {words}"))
        return found

    def state(self) -> list[Signal]:
        """Return estimate of each state, and covariance on and above the diagonal."""
        found = self.fed_back
        return [
            *(ESTIMATE.of(x, x=x) for x in found),
            *(
                Signal(
                    effect(first, "covariance", second),
                    _product(first.unit, second.unit),
                    description=f"covariance of {first.name} and {second.name} as expected",
                    matrix="covariance",
                )
                for first, second in combinations_with_replacement(found, 2)
            ),
        ]

    def known(self, sample: Sample, reading: Reading) -> list[ca.SX]:
        """Return the estimate corrected by the measurements of this sample, and its covariance."""
        found = self.correct(sample, reading.measurements.values(), reading.known)
        for x, estimate in zip(self.fed_back, found, strict=False):
            sample.name(x, {"state": estimate})
        return found

    def move_on(self, sample: Sample, known: Sequence[ca.SX], applied: Sequence[ca.SX]) -> None:
        """Write the estimate and its covariance expected in the next sample."""
        self.predict(sample, known, applied)

    def _split(self, memory: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Return x and P."""
        n = len(self.fed_back)
        return ca.vertcat(*memory[:n]), from_upper_triangle(memory[n:], n)

    def _corrected(self, s: Symbols, before: Values, shown: Values) -> tuple[Values, Values]:
        (x, P), surprises = self._split(before), []
        for y, value, reads in zip(self.measured, shown, self._shown_by, strict=True):
            reading, slope = evaluated(self.equations, reads, s, x)
            spread = P @ slope.T
            noise = s[path(y, "sensor_noise")]
            total = (slope @ spread)[0] + noise * noise
            sure = all_of([s["known"], total > 0, is_number(total)])
            share = ca.densify(spread) / ca.if_else(sure, total, 1)
            surprises.append(ca.if_else(sure, value - reading, 0))
            x = self.equations.bounded(x + share * surprises[-1])
            P = ca.triu2symm(ca.triu(P - ca.if_else(sure, share @ spread.T, 0)))
        return [*ca.vertsplit(x), *upper_triangle(P)], surprises

    def _following(self, s: Symbols, estimate: Values, inputs: Values) -> Values:
        (x, P), applied = self._split(estimate), ca.vertcat(*inputs)
        time, _ = time_step_of(s)
        rates, constants = function_in(self.equations, [ca.densify(self.equations.rates)], s)
        end = runge_kutta(rates, self.substeps)(time, x, applied, constants)
        spread = self._spread(s, x, P, time, applied)
        return [*ca.vertsplit(self.equations.bounded(end)), *upper_triangle(spread)]

    def _taken(self, goes_on: ca.SX, ends: Values) -> Values:
        x, P = self._split(ends)
        moves = all_of([goes_on, *map(is_number, ca.vertsplit(x))])
        # Never surer than not at all, nor less sure than of a state that may be anything.
        spans = ca.DM([min(signal.span**2, 1e300) for signal in self.fed_back])
        variances = ca.diag(P)
        inside = ca.vertsplit(ca.logic_and(variances >= 0, variances <= spans))
        entries = ends[len(inside) :]
        spreads = all_of([moves, *inside, *map(is_number, entries)])
        return [moves] * len(inside) + [spreads] * len(entries)

    def _spread(self, s: Symbols, x: ca.SX, P: ca.SX, time: ca.SX, applied: ca.SX) -> ca.SX:
        """Return P of the next sample."""
        here = self.equations.bounded(x, NEARLY_EMPTY)
        A, *acting = evaluated(self.equations, self._linear, s, here, applied)
        held = held_matrix(A, time, self.doublings)
        intensity = ca.SX(0)
        for acts, part, of in zip(acting, _NOISES, self._noisy, strict=False):
            scaled = acts @ ca.diag(column(s, part, of))
            intensity = intensity + scaled @ scaled.T
        noise = (0.5 * time) * (intensity + held @ intensity @ held.T)
        return held @ P @ held.T + noise


def _product(first: str, second: str) -> str:
    units = [f"({unit})" if "/" in unit else unit for unit in (first, second) if unit != "1"]
    if len(units) == 2 and first == second:
        return f"{units[0]}^2"
    return " ".join(units) or "1"
