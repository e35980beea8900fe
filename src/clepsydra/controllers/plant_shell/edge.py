"""The edge of a controller: ports in the units that the process file shows, SI inside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

import casadi as ca

from clepsydra.base.conversion import conversion
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import convertible, from_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER, LARGEST_RATES
from clepsydra.program.step_law import Equations, Symbols, step_law

AnyController = TypeVar("AnyController", bound=Controller)


def at_port(signal: Signal) -> Signal:
    """Return a signal in the unit that its reader sees, with range and initial value.

    What stands for no limit of a rate is the same number in every unit. What stands for no bound
    is too, but where the unit is so large that the law takes less of it.

    Examples
    --------
    >>> at_port(Signal("level.sp", "m", display_unit="cm", low=0.0, high=0.2, initial=0.07))
    Signal(name='level.sp', unit='cm', display_unit='', low=0.0, high=20.0, initial=7.0, \
kind='real', description='')
    >>> for unit in ("cm", "km"):
    ...     end = Signal("level.range_high", "m", display_unit=unit, low=-1e9, high=1e9)
    ...     print(f"{at_port(end).high:g} {unit}")
    1e+09 cm
    1e+06 km
    """
    shown = signal.shown_unit
    if signal.kind != "real" or shown == signal.unit or not convertible(shown, signal.unit):
        return signal

    def in_shown_unit(value: float) -> float:
        found = from_si(value, signal.unit, shown)
        if abs(value) < LARGEST_PARAMETER:
            return found
        return value if signal.part in LARGEST_RATES else min(value, found, key=abs)

    low, high, initial = map(in_shown_unit, (signal.low, signal.high, signal.initial))
    return replace(signal, unit=shown, display_unit="", low=low, high=high, initial=initial)


def in_shown_units(controller: AnyController) -> AnyController:
    """Return a controller whose inputs, parameters and outputs are in the units that are shown.

    Each that is shown in another unit than SI is converted where it enters or leaves the law, by
    one operation; the law itself, and its state, stay as they are. A controller whose inputs and
    outputs are shown in SI stays in SI altogether.

    `controller`: with a law of expressions.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("wet-well")
    >>> controller = cl.design.simc(plant)
    >>> for each in (controller, in_shown_units(controller)):
    ...     gain = each.law.parameters[0]
    ...     print(f"{each.values[gain.name]:.5g} {gain.unit}")
    -189.9 1/A
    -18.99 %/mA
    """
    law = controller.law
    entering = (*law.inputs, *law.parameters)
    every = (*entering, *law.outputs)
    ports = {signal.name: at_port(signal) for signal in every}
    if all(ports[signal.name] == signal for signal in (*law.inputs, *law.outputs)):
        return controller

    def equations(symbols: Symbols) -> Equations:
        assert law.equations is not None
        inside = {s.name: _entered(ports[s.name], s, symbols[s.name]) for s in entering}
        found = law.equations({**symbols, **inside})
        given = {
            s.name: _converted(s.unit, ports[s.name].unit, found.outputs[s.name])
            for s in law.outputs
        }
        # What is scaled is named after its port.
        before, after = {**inside, **found.outputs}, {**symbols, **given}
        scaled = {path(n, "si"): x for n, x in before.items() if x is not after[n]}
        return Equations(found.next_state, given, {**scaled, **found.intermediates})

    def shown(values: Mapping[str, float]) -> dict[str, float]:
        found = (at_port(replace(s, initial=values[s.name])) for s in entering if s.name in values)
        return {port.name: port.initial for port in found}

    edged = step_law(
        law.name,
        inputs=[ports[signal.name] for signal in law.inputs],
        parameters=[ports[signal.name] for signal in law.parameters],
        state=law.state,
        outputs=[ports[signal.name] for signal in law.outputs],
        equations=equations,
        description=law.description,
        blocks=law.blocks,
    )
    return replace(
        controller,
        law=edged,
        values=shown(controller.values),
        free_inputs=shown(controller.free_inputs),
    )


def _entered(port: Signal, signal: Signal, value: ca.SX) -> ca.SX:
    """Return what is given at a port as the law takes it."""
    found = _converted(port.unit, signal.unit, value)
    if signal.part in LARGEST_RATES and found is not value:
        return ca.if_else(value < LARGEST_PARAMETER, found, value)
    return found


def _converted(source: str, target: str, value: ca.SX) -> ca.SX:
    way = conversion(source, target)
    return value if way is None else way(value)
