"""The wires of a loop: what passes between the process, in SI, and a controller, in its units."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.base.conversion import Conversion, conversion
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.process.process import Process


def wire_conversions(controller: Controller, process: Process) -> dict[str, Conversion]:
    """Return the signals of a law that have another unit than what they are wired to.

    Parameters
    ----------
    controller : Controller
    process : Process

    Returns
    -------
    dict
        Input of the law to how it comes from the unit of the process, output to how it gets there.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.plant_shell.edge import in_shown_units
    >>> plant = cl.load("wet-well")
    >>> controller = in_shown_units(cl.design.simc(plant))
    >>> wire_conversions(controller, plant.process)["duty.out"]
    Conversion(code='divide', number=100.0)
    """
    law = controller.law
    units = {s.name: s.unit for s in (*process.measurements, *process.inputs)}
    found: dict[str, Conversion | None] = {}
    for signal in law.inputs:
        found[signal.name] = conversion(_unit(signal, controller.input_wires, units), signal.unit)
    for signal in law.outputs:
        found[signal.name] = conversion(signal.unit, _unit(signal, controller.output_wires, units))
    return {name: way for name, way in found.items() if way is not None}


def _unit(signal: Signal, wires: Mapping[str, str], units: Mapping[str, str]) -> str:
    """Return the unit of what a signal is wired to; its own where that is not of the process."""
    if signal.kind != "real":
        return signal.unit
    wire = wires.get(signal.name, "")
    return units.get(wire) or units.get(Signal(wire).owner, signal.unit)
