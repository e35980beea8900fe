"""The edge of a controller: ports in the units that the process file shows, SI inside."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import casadi as ca

from clepsydra.base.conversion import conversion
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import convertible, from_si
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import remembered_parameters
from clepsydra.controllers.signals import LARGEST_PARAMETER, LARGEST_RATES
from clepsydra.program.step_law import Equations, Symbols, step_law

AnyController = TypeVar("AnyController", bound=Controller)


def at_port(signal: Signal) -> Signal:
    """Return a signal in the unit that its reader sees, with range and initial value.

    What stands for no bound, and for no limit of a rate, is the same number in every unit.

    Examples
    --------
    >>> at_port(Signal("level.sp", "m", display_unit="cm", low=0.0, high=0.2, initial=0.07))
    Signal(name='level.sp', unit='cm', display_unit='', low=0.0, high=20.0, initial=7.0, \
kind='real', description='')
    """
    shown = signal.shown_unit
    if signal.kind != "real" or shown == signal.unit or not convertible(shown, signal.unit):
        return signal

    def in_shown_unit(value: float) -> float:
        unbounded = abs(value) >= LARGEST_PARAMETER
        return value if unbounded else from_si(value, signal.unit, shown)

    low, high, initial = map(in_shown_unit, (signal.low, signal.high, signal.initial))
    return replace(signal, unit=shown, display_unit="", low=low, high=high, initial=initial)


def in_shown_units(controller: AnyController) -> AnyController:
    """Return a controller whose inputs, parameters and outputs are in the units that are shown.

    Each that is shown in another unit than SI is converted where it enters or leaves the law, by
    one operation; the law itself, and its state, stay as they are.

    Parameters
    ----------
    controller : Controller
        With a law of expressions.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("wet-well")
    >>> controller = cl.design.simc(plant)
    >>> at_edge = in_shown_units(controller)
    >>> for each in (controller, at_edge):
    ...     print(each.law.inputs[0].unit, each.values["level.proportional_gain"])
    """
    law = controller.law
    ports = {s.name: at_port(s) for s in (*law.inputs, *law.parameters, *law.outputs)}
    if all(ports[s.name] == s for s in (*law.inputs, *law.parameters, *law.outputs)):
        return controller
    entering = (*law.inputs, *law.parameters)

    def equations(symbols: Symbols) -> Equations:
        assert law.equations is not None
        inside = {signal.name: _entered(signal, symbols[signal.name]) for signal in entering}
        found = law.equations({**symbols, **inside})
        outputs = {
            s.name: _converted(s.unit, ports[s.name].unit, found.outputs[s.name])
            for s in law.outputs
        }
        before, after = {**inside, **found.outputs}, {**symbols, **outputs}
        scaled = {path(n, "si"): x for n, x in before.items() if x is not after[n]}
        return Equations(found.next_state, outputs, {**scaled, **found.intermediates})

    values = {
        s.name: at_port(replace(s, initial=controller.values[s.name])).initial
        for s in law.parameters
    }
    inside = {s.name: float(_entered(s, values[s.name])) for s in law.parameters}
    # What is remembered of a parameter is what it is inside, to the last bit.
    was, remembered = (remembered_parameters(law, each) for each in (controller.values, inside))
    state = {
        n: remembered[n] if was.get(n) == x else x for n, x in controller.initial_state.items()
    }
    rest = {
        s.name: at_port(replace(s, initial=controller.free_inputs[s.name])).initial
        for s in law.inputs
        if s.name in controller.free_inputs
    }
    return replace(
        controller,
        law=step_law(
            law.name,
            inputs=[ports[s.name] for s in law.inputs],
            parameters=[ports[s.name] for s in law.parameters],
            state=law.state,
            outputs=[ports[s.name] for s in law.outputs],
            equations=equations,
            description=law.description,
            blocks=law.blocks,
        ),
        values=values,
        initial_state=state,
        free_inputs=rest,
    )


def _entered(signal: Signal, value: Any) -> Any:
    """Return what is given at a port, in the unit of the law."""
    found = _converted(signal.shown_unit, signal.unit, value)
    if signal.part in LARGEST_RATES and found is not value:
        return ca.if_else(value < LARGEST_PARAMETER, found, value)
    return found


def _converted(source: str, target: str, value: Any) -> Any:
    way = conversion(source, target)
    return value if way is None else way(value)
