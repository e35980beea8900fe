"""What a law of feedback linearisation knows of its process: state, derivatives and effects."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.observers.measured_state import sensors_of_states, zero_and_slope
from clepsydra.controllers.observers.model_observer import ModelObserver
from clepsydra.controllers.process_equations import model_parameter
from clepsydra.linear.process_symbols import Constant
from clepsydra.linear.relative_degree import VectorRelativeDegree
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Evaluated:
    """The linearised process in a sample.

    Parameters
    ----------
    derivatives : list of list of casadi.SX
        For each output y, dy/dt, … by the drift alone; the last is its entry of L.
    effects : list of list of casadi.SX [q][m]
        E.
    following : callable
        Takes the inputs that were applied and returns the next state of the observer.

    Examples
    --------
    >>> Evaluated([[ca.SX(5), ca.SX(0)]], [[ca.SX(0.04)]], lambda applied: {}).through([ca.SX(2)])
    [SX(0.08)]
    """

    derivatives: list[list[ca.SX]]
    effects: list[list[ca.SX]]
    following: Callable[[Sequence[ca.SX]], dict[str, ca.SX]]

    def through(self, inputs: Sequence[ca.SX]) -> list[ca.SX]:
        """Return L + E u: the highest derivative of each output under these inputs."""
        found = []
        for chain, row in zip(self.derivatives, self.effects, strict=True):
            total = chain[-1]
            for effect, value in zip(row, inputs, strict=True):
                if not effect.is_zero():
                    total = total + effect * value
            found.append(total)
        return found


@dataclass(frozen=True, eq=False)
class LinearisedProcess:
    """The equations of a linearised process within a step law.

    Parameters
    ----------
    linearised : VectorRelativeDegree
    observer : ModelObserver, optional
        Where not every state is measured that the law needs.

    Raises
    ------
    InputError
        A state that the law needs is neither measured nor estimated.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.linear.relative_degree import relative_degree
    >>> process = LinearisedProcess(relative_degree(cl.load("quadruple-tank").linear))
    >>> process.measurements[2:], [each.name for each in process.parameters()][2:4]
    (('level_3', 'level_4'), ['model.tank_1.area', 'model.tank_2.area'])
    """

    linearised: VectorRelativeDegree
    observer: ModelObserver | None = None

    def __post_init__(self) -> None:
        known = self._sensors if self.observer is None else self.observer.estimated
        missing = [name for name in self.needed if name not in known]
        if missing:
            raise InputError(
                "feedback linearisation, state",
                ", ".join(missing),
                "a state that is measured or estimated: the law needs it",
                "add a sensor, or an observer",
            )

    @cached_property
    def _expressions(self) -> list[ca.SX]:
        """For each output its derivatives by the drift, then E row by row."""
        found = self.linearised
        return [each for chain in found.derivatives for each in chain[1:]] + ca.horzsplit(
            ca.vec(ca.densify(found.decoupling.T)).T
        )

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """The states that L, E and the derivatives depend on."""
        equations = self.linearised.equations
        used = _names_in(self._expressions)
        symbols = ca.vertsplit(equations.state)
        return tuple(
            name
            for name, symbol in zip(equations.states, symbols, strict=True)
            if symbol.name() in used
        )

    @cached_property
    def measurements(self) -> tuple[str, ...]:
        """What the law reads: the outputs, then what shows the other states."""
        outputs = self.linearised.equations.outputs
        if self.observer is not None:
            return tuple(dict.fromkeys((*outputs, *self.observer.measurements)))
        return tuple(dict.fromkeys((*outputs, *(self._sensors[name] for name in self.needed))))

    @cached_property
    def _sensors(self) -> dict[str, str]:
        return sensors_of_states(self.linearised.equations)

    @cached_property
    def _shown(self) -> list[ca.SX]:
        """For each state that the law needs the reading at zero, and its slope."""
        equations = self.linearised.equations
        return [x for n in self.needed for x in zero_and_slope(equations, n, self._sensors[n])]

    @cached_property
    def constants(self) -> tuple[Constant, ...]:
        """The constants of the process that the law computes with."""
        expressions = list(self._expressions)
        if self.observer is None:
            expressions += self._shown
        else:
            expressions += self.observer.expressions
        used = _names_in(expressions)
        known = self.linearised.equations.constants
        return tuple(each for each in known if each.symbol.name() in used)

    def parameters(self) -> list[Signal]:
        """Return model.* with the values of the operating point, and those of the observer."""
        found = self._models()
        return found if self.observer is None else found + self.observer.parameters()

    def _models(self) -> list[Signal]:
        return [model_parameter(each) for each in self.constants]

    def _given(self, symbols: Symbols) -> ca.SX:
        return ca.vertcat(*(symbols[signal.name] for signal in self._models()))

    def values(self) -> dict[str, float]:
        """Return the values of model.*."""
        return {model_parameter(each).name: each.value for each in self.constants}

    def evaluated(self, symbols: Symbols, measured: Sequence[ca.SX], known: ca.SX) -> Evaluated:
        """Return derivatives and effects in this sample.

        Parameters
        ----------
        symbols : mapping
            model.*, estimates, correction and time_step.
        measured : sequence of casadi.SX
            In the order of `measurements`, as numbers.
        known : casadi.SX
            Whether they may be used.
        """
        equations, observer = self.linearised.equations, self.observer
        given = self._given(symbols)
        state = ca.SX(equations.point.state)
        estimate: list[ca.SX] = []
        if observer is None:
            shown = self._at(self._shown, state, given)
            for k, name in enumerate(self.needed):
                value = measured[self.measurements.index(self._sensors[name])]
                state[equations.states.index(name)] = (value - shown[2 * k]) / shown[2 * k + 1]
        else:
            places = [self.measurements.index(name) for name in observer.measurements]
            values = [measured[k] for k in places]
            estimate = observer.estimate(
                symbols, values, known, self._models(), lambda x, s: self._read(x, self._given(s))
            )
            state = self._with_estimate(estimate)
        values = self._at(self._expressions, state, given)
        derivatives, place = [], 0
        for name, degree in zip(equations.outputs, self.linearised.degrees, strict=True):
            own = measured[self.measurements.index(name)]
            derivatives.append([own, *values[place : place + degree]])
            place += degree
        count = len(equations.inputs)
        effects = [values[k : k + count] for k in range(place, len(values), count)]

        def following(applied: Sequence[ca.SX]) -> dict[str, ca.SX]:
            if observer is None:
                return {}
            return observer.predicted(
                symbols,
                estimate,
                applied,
                self._models(),
                lambda x, u, s: self._rates(x, u, self._given(s)),
            )

        return Evaluated(derivatives, effects, following)

    def _with_estimate(self, estimate: Sequence[ca.SX]) -> ca.SX:
        assert self.observer is not None
        equations = self.linearised.equations
        state = ca.SX(equations.point.state)
        for name, value in zip(self.observer.estimated, estimate, strict=True):
            state[equations.states.index(name)] = value
        return state

    def _read(self, estimate: Sequence[ca.SX], given: ca.SX) -> list[ca.SX]:
        assert self.observer is not None
        readings = [self.linearised.equations.reading(n) for n in self.observer.measurements]
        return self._at(readings, self._with_estimate(estimate), given)

    def _rates(
        self, estimate: Sequence[ca.SX], applied: Sequence[ca.SX], given: ca.SX
    ) -> list[ca.SX]:
        assert self.observer is not None
        equations = self.linearised.equations
        places = [equations.states.index(name) for name in self.observer.estimated]
        rates = [equations.rates[place] for place in places]
        return self._at(rates, self._with_estimate(estimate), given, ca.vertcat(*applied))

    def _at(
        self,
        expressions: Sequence[ca.SX],
        state: ca.SX,
        given: ca.SX,
        moved: ca.SX | None = None,
    ) -> list[ca.SX]:
        """Return expressions in a state, each operation that they share written once."""
        equations = self.linearised.equations
        moved = ca.SX.zeros(equations.moved.numel()) if moved is None else moved
        constants = ca.vertcat(*(each.symbol for each in self.constants))
        symbols = [equations.state, constants, equations.moved]
        function = ca.Function("at", symbols, [ca.vertcat(*expressions)])
        return ca.vertsplit(ca.densify(function(state, given, moved)))


def _names_in(expressions: Sequence[ca.SX]) -> set[str]:
    return {symbol.name() for symbol in ca.symvar(ca.vertcat(*expressions))}
