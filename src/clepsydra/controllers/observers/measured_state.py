"""A state that sensors show as a whole, beside the observers that estimate one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.process_equations import ProcessEquations
from clepsydra.linear.lie_derivatives import Constant
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
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> from clepsydra.process.reader import load_process
    >>> source: StateSource = MeasuredState(
    ...     process_equations(analyse(load_process("averaging-tank")).model))
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
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> from clepsydra.process.reader import load_process
    >>> MeasuredState(process_equations(analyse(load_process("quadruple-tank")).model)).measurements
    ('level_1', 'level_2', 'level_3', 'level_4')
    """

    equations: ProcessEquations

    def __post_init__(self) -> None:
        missing = [name for name in self.equations.states if name not in self._showing]
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
        shown = (self._showing[name] for name in self.equations.states)
        return tuple(dict.fromkeys((*self.equations.outputs, *shown)))

    @property
    def _showing(self) -> dict[str, str]:
        found: dict[str, str] = {}
        equations = self.equations
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

    def _shown(self) -> list[ca.SX]:
        """Return for each state the reading at zero, and its slope."""
        equations, found = self.equations, []
        zero = ca.SX.zeros(len(equations.states))
        for place, name in enumerate(equations.states):
            reading = equations.reading(self._showing[name])
            slope = ca.jacobian(reading, equations.state[place])
            found += [ca.substitute(reading, equations.state, zero), slope]
        return found

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
            value = measured[self.measurements.index(self._showing[name])]
            slope = shown[2 * k + 1]
            state.append((value - shown[2 * k]) / ca.if_else(slope == 0, 1, slope))
        return KnownState(state, lambda applied: {}, {})
