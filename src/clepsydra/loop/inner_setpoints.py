"""The setpoints that a cascade gives to its inner loops."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from clepsydra.base.conversion import conversion
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.process.process import Process


@dataclass(frozen=True)
class InnerSetpoint:
    """The setpoint of an inner loop, which another block of the scheme gives.

    Parameters
    ----------
    signal : Signal
        "duty_flow.inner_setpoint", with the unit and range of the measurement.
    measurement : str
        What the inner loop measures.
    state : str
        The state of the step law that holds it after a sample.
    low, high : float
        Between which the loop takes it [measurement unit].
    """

    signal: Signal
    measurement: str
    state: str
    low: float
    high: float

    @property
    def name(self) -> str:
        """Its name in a run."""
        return self.signal.name


def inner_loops(controller: Controller) -> list[tuple[PidBlock, str]]:
    """Return the loops whose setpoint another block gives, each with what it measures."""
    return [
        (block, block.measurement.name)
        for block in controller.law.blocks
        if isinstance(block, PidBlock) and block.inner
    ]


def inner_setpoints(controller: Controller, process: Process) -> tuple[InnerSetpoint, ...]:
    """Return the setpoints that the blocks of a control scheme give to its inner loops.

    Where two inner loops measure the same signal the name of the loop stands behind it.

    Examples
    --------
    A single loop has none:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> inner_setpoints(controller, plant.process)
    ()
    """
    inner = inner_loops(controller)
    loops = Counter(measurement for _, measurement in inner)
    units = {parameter.name: parameter.unit for parameter in controller.law.parameters}
    found = []
    for block, measurement in inner:
        y = process.signal(measurement)
        loop = f"_{block.owner}" if loops[measurement] > 1 else ""
        signal = Signal(
            f"{measurement}.inner_setpoint{loop}",
            y.unit,
            y.display_unit,
            y.low,
            y.high,
            description=f"setpoint that {block.setpoint} gives for {measurement}",
        )
        names = [path(block.owner, f"setpoint_{end}_limit") for end in ("low", "high")]
        ways = [conversion(units[name], y.unit) for name in names]
        low, high = (
            value if way is None else way(value)
            for value, way in zip(map(controller.values.__getitem__, names), ways, strict=True)
        )
        state = path(block.owner, "working_setpoint")
        found.append(InnerSetpoint(signal, measurement, state, low, high))
    return tuple(found)
