"""What flows where: the elements of a process as a graph for the drawing."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.process.flow_splitter import FlowSplitter
from clepsydra.process.inflow import Inflow
from clepsydra.process.level_sensor import LevelSensor
from clepsydra.process.orifice import Orifice
from clepsydra.process.process import Process
from clepsydra.process.pump import Pump
from clepsydra.process.tank import Tank


@dataclass(frozen=True)
class Split:
    """A flow splitter and the share that each destination receives.

    Examples
    --------
    >>> Split("valve", ((0.7, "tank_1"), (0.3, "tank_4"))).branches[0]
    (0.7, 'tank_1')
    """

    name: str
    branches: tuple[tuple[float, str | Split], ...]


@dataclass(frozen=True)
class Outlet:
    """A flow that leaves a tank by its own weight.

    Examples
    --------
    >>> Outlet("outlet_3", "tank_3", "tank_1").target
    'tank_1'
    """

    name: str
    source: str
    target: str | Split


@dataclass(frozen=True)
class Feed:
    """A flow that is brought in: by a pump from `source`, or as a disturbance from outside.

    Examples
    --------
    >>> Feed("inflow_1", False, "", "tank_1").pumped
    False
    """

    name: str
    pumped: bool
    source: str
    target: str | Split


@dataclass(frozen=True)
class FlowGraph:
    """Tanks in the order of the file, their outlets, and what feeds them.

    Parameters
    ----------
    tanks : tuple of str
    outlets : tuple of Outlet
    feeds : tuple of Feed
    sensors : tuple of (sensor, tank)

    Examples
    --------
    >>> upper, lower = Outlet("a", "upper", "lower"), Outlet("b", "lower", "basin")
    >>> FlowGraph(("upper", "lower"), (upper, lower), (), ()).layers()
    {'lower': 0, 'upper': 1}
    """

    tanks: tuple[str, ...]
    outlets: tuple[Outlet, ...]
    feeds: tuple[Feed, ...]
    sensors: tuple[tuple[str, str], ...]

    def layers(self) -> dict[str, int]:
        """Return how many tanks lie below each tank on its longest way down.

        An outlet that would close a circle of tanks is left out.
        """
        below: dict[str, int] = {}

        def height(tank: str, above: tuple[str, ...]) -> int:
            if tank not in below:
                below[tank] = max(
                    (
                        1 + height(lower, (*above, tank))
                        for outlet in self.outlets
                        if outlet.source == tank
                        for lower in leaves(outlet.target)
                        if lower in self.tanks and lower not in (*above, tank)
                    ),
                    default=0,
                )
            return below[tank]

        for tank in self.tanks:
            height(tank, ())
        return below


def leaves(target: str | Split) -> list[str]:
    """Return the tanks and reservoirs that a feed ends in.

    Examples
    --------
    >>> leaves(Split("valve", ((0.7, "tank_1"), (0.3, Split("tee", ((1.0, "tank_2"),))))))
    ['tank_1', 'tank_2']
    """
    if isinstance(target, str):
        return [target]
    return [leaf for _, branch in target.branches for leaf in leaves(branch)]


def flow_graph(process: Process) -> FlowGraph:
    """Read the flows of a process from its elements.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> flow_graph(load_process("quadruple-tank")).layers()
    {'tank_1': 0, 'tank_2': 0, 'tank_3': 1, 'tank_4': 1}
    """
    splitters = {
        element.name: element for element in process.elements if isinstance(element, FlowSplitter)
    }

    def target(name: str) -> str | Split:
        if name not in splitters:
            return name
        shares = splitters[name].destinations.items()
        return Split(name, tuple((share, target(receiver)) for receiver, share in shares))

    tanks, outlets, feeds, sensors = [], [], [], []
    for element in process.elements:
        if isinstance(element, Tank):
            tanks.append(element.name)
        elif isinstance(element, Orifice):
            outlets.append(Outlet(element.name, element.source, target(element.destination)))
        elif isinstance(element, Pump):
            destination = target(element.destination)
            feeds.append(Feed(element.name, True, element.source, destination))
        elif isinstance(element, Inflow):
            feeds.append(Feed(element.name, False, "", target(element.destination)))
        elif isinstance(element, LevelSensor):
            sensors.append((element.name, element.tank))
    return FlowGraph(tuple(tanks), tuple(outlets), tuple(feeds), tuple(sensors))
