"""A catchment: rain on a surface, which holds the water back before it runs off into a tank."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.quantity import quantity
from clepsydra.base.signal import Signal
from clepsydra.process.declared import filled, link
from clepsydra.process.element import Element
from clepsydra.process.flow import Flow, Flows
from clepsydra.process.outside_signal import ranged
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Catchment(Element):
    """A linear reservoir: T q′ = ψ A i − q, with the rain i and the runoff q.

    What falls on the surface A runs off to the share ψ, and the water that stands on it is T q.
    So a cloudburst reaches the tank as a lag and not as a step. The water is clean.

    It is the first member of the cascade of J. E. Nash, The form of the instantaneous unit
    hydrograph, IAHS Publication 45, 1957, 114-121; a transport delay adds the way through sewers.

    Parameters
    ----------
    name : str
        Also the name of its signal, the intensity of the rain i [m/s], a disturbance.
    area : float
        A [m²]
    runoff_share : float
        ψ [1], 0.9 of a roof or asphalt, 0.1 of a meadow.
    time : float
        T [s]

    Examples
    --------
    36 mm an hour, 1e-5 m/s, on a hectare of roofs bring 90 l/s in the end; a lag of 600 s goes
    there at 0.15 l/s a second.

    >>> roofs = Catchment("roofs", "well", 1e4, 0.9, 600.0, 0.0, 1e-4, 0.0)
    >>> values = {signal.name: signal.initial for signal in roofs.parameters()}
    >>> rate = roofs.rates(values | {"roofs": 1e-5, "roofs.runoff": 0.0}, (), ())["roofs.runoff"]
    >>> round(float(rate), 9)
    0.00015
    """

    kind, table, symbol, place = "catchment", "catchments", "flow", 8
    tagged = True

    destination: str = link("the name of a tank", "receiver")
    area: float = quantity("m^2", "an area", "surface of", above=0.0, remedy="measure it in a plan")
    runoff_share: float = quantity(
        "1",
        "a share",
        "share of the rain that runs off from",
        above=0.0,
        at_most=1.0,
        remedy="give 0.9 for a roof, 0.1 for a meadow",
    )
    time: float = quantity(
        "s", "a time", "time constant of", above=0.0, remedy="give the time after which 63 % run"
    )
    low: float = ranged("m/s", "the rain", "rain intensity")
    high: float = filled()
    nominal: float = filled()
    steps: tuple[float, ...] = ()

    @property
    def _runoff(self) -> str:
        return f"{self.name}.runoff"

    def states(self) -> tuple[Signal, ...]:
        """Return the runoff, at rest with the nominal rain."""
        share = self.runoff_share * self.area
        ends = share * self.low, share * self.high, share * self.nominal
        return (Signal(self._runoff, "m^3/s", "", *ends, description=f"runoff of {self.name}"),)

    def disturbances(self) -> tuple[Signal, ...]:
        """Return the rain."""
        ends = self.low, self.high, self.nominal
        return (self._signal(self.name, "m/s", ends, f"rain on {self.name}"),)

    def load_steps(self) -> dict[str, tuple[float, ...]]:
        """Return the step of the rain."""
        return {self.name: self.steps} if self.steps else {}

    def flows(self, symbols: Symbols, received: Flows) -> tuple[Flow, ...]:
        """Return the runoff."""
        clean = {component.name: ca.SX(0) for component in self.components}
        return (Flow("", self.destination, ca.SX(1), ca.SX(symbols[self._runoff]), fluxes=clean),)

    def rates(self, symbols: Symbols, received: Flows, given: Flows) -> dict[str, ca.SX]:
        """Return q′ = (ψ A i − q)/T."""
        share, area, time = (
            symbols[f"{self.name}.{name}"] for name in ("runoff_share", "area", "time")
        )
        return {self._runoff: (share * area * symbols[self.name] - symbols[self._runoff]) / time}
