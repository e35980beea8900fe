"""What a law of feedback linearisation knows of its process: state, derivatives and effects."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.sample import Sample
from clepsydra.controllers.observers.measured_state import (
    sensors_of_states,
    shown_states,
    zeros_and_slopes,
)
from clepsydra.controllers.observers.model_observer import ModelObserver
from clepsydra.controllers.process_model import evaluated, model_parameter, used_in
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
    """

    derivatives: list[list[ca.SX]]
    effects: list[list[ca.SX]]
    following: Callable[[Sequence[ca.SX]], dict[str, ca.SX]]

    def through(self, inputs: Sequence[ca.SX]) -> list[ca.SX]:
        """Return L + E u: the highest derivative of each output under these inputs."""
        return [
            sum((e * u for e, u in zip(row, inputs, strict=True) if not e.is_zero()), chain[-1])
            for chain, row in zip(self.derivatives, self.effects, strict=True)
        ]


class LinearisedProcess:
    """The equations of a linearised process within a step law.

    Parameters
    ----------
    observer : ModelObserver, optional
        Where not every state is measured that the law needs.

    Raises InputError: A state that the law needs is neither measured nor estimated.
    """

    def __init__(
        self, linearised: VectorRelativeDegree, observer: ModelObserver | None = None
    ) -> None:
        self.linearised, self.observer = linearised, observer
        equations = linearised.equations
        # For each output its derivatives by the drift, then E row by row.
        drift = [each for chain in linearised.derivatives for each in chain[1:]]
        found = ca.vertcat(*drift, ca.vec(ca.densify(linearised.decoupling.T)))
        pairs = zip(equations.states, ca.vertsplit(equations.state), strict=True)
        needed = [name for name, symbol in pairs if ca.depends_on(found, symbol)]
        sensors = sensors_of_states(equations)
        known = observer.equations.states if observer else sensors
        if missing := [name for name in needed if name not in known]:
            raise InputError(
                "feedback linearisation, state",
                ", ".join(missing),
                "a state that is measured or estimated: the law needs it",
                "add a sensor, or an observer",
            )
        self._sensors = {} if observer else {name: sensors[name] for name in needed}
        shown = observer.measurements if observer else self._sensors.values()
        # What the law reads: the outputs, then what shows the other states.
        self.measurements = tuple(dict.fromkeys((*equations.outputs, *shown)))
        others = observer.expressions if observer else zeros_and_slopes(equations, self._sensors)
        # The constants of the process that it computes with.
        self.constants = used_in(equations, [found, *others])
        self._expressions = found

    def parameters(self) -> list[Signal]:
        """Return model.* with the values of the operating point, and those of the observer."""
        own = self.observer.correction.signals() if self.observer else []
        return [*map(model_parameter, self.constants), *own]

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
        sample, shown = Sample(symbols), dict(zip(self.measurements, measured, strict=True))
        state = ca.SX(equations.point.state)
        if observer:
            names = observer.equations.states
            found = observer.correct(sample, [shown[y] for y in observer.measurements], known)
        else:
            names = tuple(self._sensors)
            found = shown_states(equations, self._sensors, symbols, shown)
        for name, value in zip(names, found, strict=True):
            state[equations.states.index(name)] = value
        (terms,) = evaluated(equations, [self._expressions], symbols, state)
        values = iter(ca.vertsplit(ca.densify(terms)))
        degrees = zip(equations.outputs, self.linearised.degrees, strict=True)
        derivatives = [[shown[y], *islice(values, degree)] for y, degree in degrees]
        effects = [list(islice(values, len(equations.inputs))) for _ in equations.outputs]

        def following(applied: Sequence[ca.SX]) -> dict[str, ca.SX]:
            if observer:
                observer.predict(sample, found, applied)
            return sample.next_state

        return Evaluated(derivatives, effects, following)
