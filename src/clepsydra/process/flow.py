"""A flow: liquid on its way from one element to another, with what is dissolved in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca


@dataclass(frozen=True)
class Flow:
    """A volumetric flow, coefficient · driver [m³/s], positive from source to destination.

    The two factors are kept apart so that everything that depends on parameters only is
    computed once a run and not once a step.

    Parameters
    ----------
    source, destination : str
        Elements; empty where the liquid comes from outside the plant or leaves it.
    coefficient : casadi.SX
        Depends on parameters only.
    driver : casadi.SX
        Depends on states, inputs or disturbances.
    element : str
        The element that causes it, for sensors of flow.
    reversible : bool
        It may become negative, and then carries what its destination holds.
    fluxes : mapping or None
        Component to the amount that it carries [amount/s]; None where it carries what its
        source holds.

    Examples
    --------
    The flow of a pump, gain · voltage:

    >>> gain, voltage = ca.SX.sym("gain"), ca.SX.sym("voltage")
    >>> flow = Flow("basin", "tank_1", gain, voltage)
    >>> str(flow.rate)
    '(gain*voltage)'
    """

    source: str
    destination: str
    coefficient: ca.SX
    driver: ca.SX
    element: str = ""
    reversible: bool = False
    fluxes: Mapping[str, ca.SX] | None = None

    @property
    def rate(self) -> ca.SX:
        """The flow [m³/s]."""
        return self.coefficient * self.driver

    def held_back(self, truth: ca.SX, *, back: bool = False) -> Flow:
        """Return the flow as it is while nothing can enter its destination, or its source.

        Parameters
        ----------
        back : bool
            What runs back to the source is held, and not what runs to the destination.
        """
        if self.reversible:
            rest = ca.fmax(self.driver, 0) if back else ca.fmin(self.driver, 0)
        else:
            rest = ca.SX(0)
        fluxes = self.fluxes
        if fluxes is not None:
            fluxes = {name: ca.if_else(truth, 0, flux) for name, flux in fluxes.items()}
        return replace(self, driver=ca.if_else(truth, rest, self.driver), fluxes=fluxes)

    def carrying(self, upstream: Mapping[str, ca.SX], downstream: Mapping[str, ca.SX]) -> Flow:
        """Return the flow with the fluxes of a stream that carries what it is drawn from.

        Parameters
        ----------
        upstream, downstream : mapping
            Component to concentration at the source and at the destination [amount/m³].

        Examples
        --------
        >>> flow = Flow("a", "b", ca.SX(2.0), ca.SX(-1.0), reversible=True)
        >>> str(flow.carrying({"salt": ca.SX(10.0)}, {"salt": ca.SX(3.0)}).fluxes["salt"])
        '-6'
        """
        fluxes = {}
        for component, concentration in upstream.items():
            if self.reversible:
                back = ca.fmin(self.rate, 0) * downstream[component]
                fluxes[component] = ca.fmax(self.rate, 0) * concentration + back
            else:
                fluxes[component] = self.rate * concentration
        return replace(self, fluxes=fluxes)


#: What an element receives, or what is drawn from it.
Flows = Sequence[Flow]
