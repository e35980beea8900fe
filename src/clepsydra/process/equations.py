"""The equations of a process: its elements joined to dx/dt = f(x, u, d, p) and y = g(x, p)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.element import Element, Flow
from clepsydra.process.wiring import flow_order


@dataclass(frozen=True)
class JoinedEquations:
    """Signals and functions of a plant, as `Process` holds them.

    Parameters
    ----------
    state, inputs, disturbances, measurements, parameters : tuple of Signal
    measured_state : dict
        Measurement name to state name.
    dynamics : casadi.Function
        (x [n], u [m], d [k], p [l]) → dx/dt [n], SI.
    measure : casadi.Function
        (x [n], p [l]) → y [q], in the unit of each measurement.

    Examples
    --------
    >>> from clepsydra.process.tank import Tank
    >>> joined = join([Tank("tank", 0.01, 0.3)], Signal("gravity", "m/s^2", initial=9.81))
    >>> [signal.name for signal in joined.parameters], joined.dynamics.size_out(0)
    (['tank.area', 'gravity'], (1, 1))
    """

    state: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    measurements: tuple[Signal, ...]
    parameters: tuple[Signal, ...]
    measured_state: dict[str, str]
    dynamics: ca.Function
    measure: ca.Function


def join(elements: Sequence[Element], gravity: Signal) -> JoinedEquations:
    """Join elements to one set of equations in which every parameter is symbolic.

    Parameters
    ----------
    elements : sequence of Element
        Properly connected, see `clepsydra.process.wiring.check_wiring`.
    gravity : Signal
        Acceleration of gravity [m/s²], the last parameter.

    Examples
    --------
    A tank of 100 cm² that empties through 1 cm² falls from 20 cm at once by 1.98 cm/s.

    >>> from clepsydra.process.orifice import Orifice
    >>> from clepsydra.process.reservoir import Reservoir
    >>> from clepsydra.process.tank import Tank
    >>> joined = join(
    ...     [Reservoir("basin"), Tank("tank", 0.01, 0.3), Orifice("outlet", "tank", "basin", 1e-4)],
    ...     Signal("gravity", "m/s^2", initial=9.81),
    ... )
    >>> values = [signal.initial for signal in joined.parameters]
    >>> round(float(joined.dynamics([0.2], [], [], values)), 6)
    -0.019809
    """
    state = tuple(signal for element in elements for signal in element.states())
    inputs = tuple(signal for element in elements for signal in element.inputs())
    disturbances = tuple(signal for element in elements for signal in element.disturbances())
    measurements = tuple(signal for element in elements for signal in element.measurements())
    parameters = (*(p for element in elements for p in element.parameters()), gravity)
    groups = (state, inputs, disturbances, parameters)
    vectors = [ca.SX.sym(name, len(group)) for name, group in zip("xudp", groups, strict=True)]
    symbols = {
        signal.name: vector[index]
        for vector, group in zip(vectors, groups, strict=True)
        for index, signal in enumerate(group)
    }
    x, u, d, p = vectors

    flows: list[Flow] = []
    for element in flow_order(elements):
        flows += element.flows(symbols, [f for f in flows if f.destination == element.name])
    # Flows that are constant during a sample come first in every sum, so that their part of
    # the sum is computed once a sample and not in every stage of an integration step.
    flows.sort(key=lambda flow: bool(ca.depends_on(flow.driver, x)))

    rates: dict[str, ca.SX] = {}
    readings: dict[str, ca.SX] = {}
    for element in elements:
        rates |= element.derivatives(
            symbols,
            [flow for flow in flows if flow.destination == element.name],
            [flow for flow in flows if flow.source == element.name],
        )
        readings |= element.readings(symbols)
    derivative = ca.cse(ca.vertcat(*(rates[signal.name] for signal in state)))
    reading = ca.vertcat(*(readings[signal.name] for signal in measurements))
    return JoinedEquations(
        state,
        inputs,
        disturbances,
        measurements,
        parameters,
        {k: v for element in elements for k, v in element.measured_states().items()},
        ca.Function("dynamics", [x, u, d, p], [derivative], ["x", "u", "d", "p"], ["dx"]),
        ca.Function("measure", [x, p], [reading], ["x", "p"], ["y"]),
    )
