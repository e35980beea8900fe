"""A reservoir: where liquid comes from and goes to, without end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from clepsydra.process.concentrations import BringsFromOutside, GivenConcentration, brought


@dataclass(frozen=True)
class Reservoir(BringsFromOutside):
    """A basin so large that its level does not change: dh/dt = 0, h = 0.

    Parameters
    ----------
    given : mapping
        Component to its concentration in what is drawn from it.
    """

    kind, table, symbol, place = "reservoir", "reservoirs", "reservoir", 1
    receives = gives = endless = True

    given: Mapping[str, GivenConcentration] = brought()
