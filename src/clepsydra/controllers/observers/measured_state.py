"""A state that sensors show as a whole, beside the observers that estimate one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.process_equations import ProcessEquations
from clepsydra.linear.lie_derivatives import InputAffineEquations
from clepsydra.linear.process_symbols import Constant
from clepsydra.program.step_law import Symbols


class KnownState(NamedTuple):
    """The state in a sample, and how its observer goes on.

    Parameters
    ----------
    state : list of casadi.SX [n]
        x of the `ProcessEquations`, always numbers.
    following : callable
        Takes the inputs that were applied and returns the next state of the observer.
    named : dict
        Names for values on the way.

    Examples
    --------
    >>> KnownState([ca.SX(2)], lambda applied: {}, {}).state
    [SX(2)]
    """

    state: list[ca.SX]
    following: Callable[[Sequence[ca.SX]], dict[str, ca.SX]]
    named: dict[str, ca.SX]


class StateSource(Protocol):
    """What tells a law the state of the process: sensors, or an observer.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> source: StateSource = MeasuredState(process_equations(cl.load("averaging-tank").linear))
    >>> source.measurements
    ('concentration', 'volume')
    """

    @property
    def equations(self) -> ProcessEquations:
        """Of the process."""

    @property
    def measurements(self) -> tuple[str, ...]:
        """What the law reads."""

    @property
    def constants(self) -> tuple[Constant, ...]:
        """The constants of the process that it computes with."""

    def parameters(self) -> list[Signal]:
        """Its parameters beside the constants."""

    def memory(self) -> list[Signal]:
        """What it keeps from sample to sample."""

    def known(
        self,
        symbols: Symbols,
        measured: Sequence[ca.SX],
        usable: ca.SX,
    ) -> KnownState:
        """Return the state in this sample.

        Parameters
        ----------
        symbols : mapping
        measured : sequence of casadi.SX
            In the order of `measurements`, as numbers.
        usable : casadi.SX
            Whether they are numbers from sound sensors.
        """


def sensors_of_states(equations: ProcessEquations | InputAffineEquations) -> dict[str, str]:
    """Return each state with the measurement that shows it alone and in proportion, if one does.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> sensors_of_states(process_equations(cl.load("averaging-tank").linear))
    {'tank.level': 'volume', 'tank.impurity': 'concentration'}
    """
    found: dict[str, str] = {}
    for name, state in equations.point.process.measured_state.items():
        if state not in equations.states:
            continue
        slope = ca.jacobian(equations.reading(name), equations.state)
        others = [k for k, each in enumerate(equations.states) if each != state]
        bent = ca.depends_on(slope, equations.state)
        if bent or (others and slope[others].nnz()):
            continue
        # Where two sensors show a state, the one that is controlled is meant.
        if state not in found or name in equations.outputs:
            found[state] = name
    return found


def zero_and_slope(
    equations: ProcessEquations | InputAffineEquations, state: str, sensor: str
) -> tuple[ca.SX, ca.SX]:
    """Return what a sensor of `sensors_of_states` shows at a state of zero, and its slope.

    Examples
    --------
    A sensor of 50 V/m:

    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> _, slope = zero_and_slope(equations, "tank_1.level", "level_1")
    >>> [equations.used_in([slope])[0].value, slope.numel()]
    [50.0, 1]
    """
    reading = equations.reading(sensor)
    zero = ca.SX.zeros(len(equations.states))
    slope = ca.jacobian(reading, equations.state[equations.states.index(state)])
    return ca.substitute(reading, equations.state, zero), slope


@dataclass(frozen=True, eq=False)
class MeasuredState:
    """Each state by the measurement that shows it alone and in proportion.

    Parameters
    ----------
    equations : ProcessEquations

    Raises
    ------
    InputError
        A state is not measured so.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> MeasuredState(process_equations(cl.load("quadruple-tank").linear)).measurements
    ('level_1', 'level_2', 'level_3', 'level_4')
    """

    equations: ProcessEquations

    def __post_init__(self) -> None:
        missing = [name for name in self.equations.states if name not in self._sensors]
        if missing:
            raise InputError(
                "state",
                ", ".join(missing),
                "a measurement that shows the state alone and in proportion",
                "add a sensor, or an observer",
            )

    @property
    def measurements(self) -> tuple[str, ...]:
        """The controlled outputs, then what shows the other states."""
        shown = (self._sensors[name] for name in self.equations.states)
        return tuple(dict.fromkeys((*self.equations.outputs, *shown)))

    @cached_property
    def _sensors(self) -> dict[str, str]:
        return sensors_of_states(self.equations)

    def _shown(self) -> list[ca.SX]:
        """Return for each state the reading at zero, and its slope."""
        names = self.equations.states
        return [x for n in names for x in zero_and_slope(self.equations, n, self._sensors[n])]

    @property
    def constants(self) -> tuple[Constant, ...]:
        """Offsets and slopes of the sensors."""
        return self.equations.used_in(self._shown())

    def parameters(self) -> list[Signal]:
        """None."""
        return []

    def memory(self) -> list[Signal]:
        """None."""
        return []

    def known(self, symbols: Symbols, measured: Sequence[ca.SX], usable: ca.SX) -> KnownState:
        """Return what the sensors show."""
        equations = self.equations
        nothing = [ca.SX(0)] * len(equations.states), [ca.SX(0)] * len(equations.inputs)
        shown = equations.evaluated(self._shown(), *nothing, symbols)
        state = []
        for k, name in enumerate(equations.states):
            value = measured[self.measurements.index(self._sensors[name])]
            slope = shown[2 * k + 1]
            state.append((value - shown[2 * k]) / ca.if_else(slope == 0, 1, slope))
        return KnownState(state, lambda applied: {}, {})
