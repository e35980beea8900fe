"""The ways of the pipes in the process drawing, before their heights are known.

Between two layers of tanks lies a channel; a pipe that runs sideways there gets a track of its
own. Where the tracks lie follows when all pipes are known.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.report.flow_graph import Feed, Outlet, leaves
from clepsydra.report.placement import TANK_WIDTH, Placement, Riser

#: Channel below the lowest tanks.
BOTTOM = -1


@dataclass
class Crossway:
    """A horizontal stretch of a pipe; its track in the channel is found last.

    Examples
    --------
    >>> Crossway(BOTTOM, start=20.0, stop=90.0).track
    0
    """

    channel: int
    start: float
    stop: float
    track: int = 0


@dataclass
class Draft:
    """A pipe before its heights are known: x of its start, then crossways, then its end.

    Examples
    --------
    >>> Draft("pump_1", "pump_1", "pump_1 to tank_1", 20.0, [], "tank_1").receiver
    'tank_1'
    """

    source: str
    line: str
    title: str
    start: float
    crossways: list[Crossway]
    receiver: str
    end: float = 0.0


@dataclass
class Drafts:
    """The drafts of all pipes.

    Parameters
    ----------
    drains : list of (outlet, draft)
    rises : list of (riser, share, draft)
        Share is None where nothing is divided.
    joints : dict
        Place of a riser in the placement to the way to its parent.
    stub_ports : list of (inflow, tank, x)
        Where an inflow falls straight into a tank.
    tracks : dict
        Channel to its number of tracks.

    Examples
    --------
    >>> Drafts().every()
    []
    """

    drains: list[tuple[Outlet, Draft]] = field(default_factory=list)
    rises: list[tuple[Riser, float | None, Draft]] = field(default_factory=list)
    joints: dict[int, Crossway] = field(default_factory=dict)
    stub_ports: list[tuple[Feed, str, float]] = field(default_factory=list)
    tracks: dict[int, int] = field(default_factory=dict)

    def every(self) -> list[Draft]:
        """Return all drafts, those of outlets first."""
        falling = [draft for _, draft in self.drains]
        return falling + [draft for _, _, draft in self.rises]


def draft_pipes(placement: Placement) -> Drafts:
    """Find the way of every pipe.

    Examples
    --------
    Four outlets, two pumps with two branches each, and two inflows from outside:

    >>> from clepsydra.process.reader import load_process
    >>> from clepsydra.report.flow_graph import flow_graph
    >>> from clepsydra.report.placement import place
    >>> graph = flow_graph(load_process("quadruple-tank"))
    >>> labels = {feed.name: (feed.name,) for feed in graph.feeds}
    >>> drafts = draft_pipes(place(graph, labels | {"splitter_1": (), "splitter_2": ()}))
    >>> len(drafts.drains), len(drafts.rises), len(drafts.stub_ports)
    (4, 4, 2)
    """
    drafter = _Drafter(placement)
    drafter.draft_outlets()
    drafter.draft_risers()
    drafter.assign_ports()
    drafter.assign_tracks()
    return drafter.drafts


class _Drafter:
    def __init__(self, placement: Placement) -> None:
        self.placement = placement
        self.drafts = Drafts()

    def draft_outlets(self) -> None:
        """Start each outlet at the floor of its tank and send it to its receivers."""
        placement = self.placement
        for tank in placement.graph.tanks:
            own = [outlet for outlet in placement.graph.outlets if outlet.source == tank]
            central = next(
                (
                    outlet
                    for outlet in own
                    if any(placement.falls_straight(outlet, leaf) for leaf in leaves(outlet.target))
                ),
                None,
            )
            offset = 0
            for outlet in own:
                x = placement.centre[tank]
                if outlet is not central:
                    offset += 1
                    side = placement.sensor_side[tank] * (1 if offset % 2 else -1)
                    x += side * (33.0 + 18.0 * ((offset - 1) // 2))
                for receiver in leaves(outlet.target):
                    self._draft_drain(outlet, receiver, x)

    def _draft_drain(self, outlet: Outlet, receiver: str, x: float) -> None:
        placement = self.placement
        below = placement.layer[outlet.source] - 1
        draft = Draft(
            outlet.source, outlet.name, f"{outlet.name} to {receiver}", x, [], receiver, x
        )
        self.drafts.drains.append((outlet, draft))
        if placement.falls_straight(outlet, receiver):
            return
        passing = placement.downcomers.get((outlet.name, receiver))
        if passing is not None:
            draft.crossways.append(Crossway(below, x, passing))
            x = passing
        if receiver in placement.layer:
            draft.crossways.append(Crossway(placement.layer[receiver], x, x))
        else:
            draft.end = x

    def draft_risers(self) -> None:
        """Send each riser up to the tanks that it feeds, and join risers to their parents."""
        for place, riser in enumerate(self.placement.risers):
            if riser.parent is not None:
                self.drafts.joints[place] = Crossway(BOTTOM, riser.x, riser.parent.x)
            for share, receiver in riser.targets:
                channel = self.placement.layer.get(receiver, BOTTOM)
                crossway = Crossway(channel, riser.x, riser.x)
                title = f"{riser.feed.name} to {receiver}"
                draft = Draft(riser.feed.name, riser.name, title, riser.x, [crossway], receiver)
                if channel == BOTTOM:
                    draft.end = crossway.stop = riser.x + 24.0 * riser.outward
                self.drafts.rises.append((riser, share, draft))

    def assign_ports(self) -> None:
        """Spread what enters a tank over its width, in the order in which it arrives."""
        placement = self.placement
        drafts = self.drafts.every()
        for tank in placement.graph.tanks:
            centre = placement.centre[tank]
            left: list[tuple[float, Draft | Feed]] = []
            right: list[tuple[float, Draft | Feed]] = []
            for draft in drafts:
                if draft.receiver == tank and draft.crossways:
                    x = draft.crossways[-1].start
                    (left if x < centre else right).append((x, draft))
            for feed in placement.stubs:
                if feed.target == tank:
                    side = right if placement.sensor_side[tank] > 0 else left
                    side.append((centre + placement.sensor_side[tank] * TANK_WIDTH, feed))
            for group, sign in ((left, -1), (right, 1)):
                # The farther an arrival has come, the closer to the near wall it ends.
                group.sort(key=lambda entry: -abs(entry[0] - centre))
                step = (TANK_WIDTH / 2 - 14.0) / (len(group) + 0.5)
                for place, (_, arrival) in enumerate(group):
                    port = centre + sign * (TANK_WIDTH / 2 - 14.0 - step * (place + 0.3))
                    if isinstance(arrival, Feed):
                        self.drafts.stub_ports.append((arrival, tank, port))
                    else:
                        arrival.end = arrival.crossways[-1].stop = port

    def assign_tracks(self) -> None:
        """Give crossways of a channel tracks, short ones lowest, so that few pipes cross."""
        crossways = [way for draft in self.drafts.every() for way in draft.crossways]
        crossways += list(self.drafts.joints.values())
        taken: dict[tuple[int, int], list[tuple[float, float]]] = {}
        for way in sorted(crossways, key=lambda way: abs(way.stop - way.start)):
            low, high = sorted((way.start, way.stop))
            while any(
                low < end + 12.0 and start - 12.0 < high
                for start, end in taken.get((way.channel, way.track), [])
            ):
                way.track += 1
            taken.setdefault((way.channel, way.track), []).append((low, high))
        self.drafts.tracks = {
            channel: 1 + max(way.track for way in crossways if way.channel == channel)
            for channel in {way.channel for way in crossways}
        }
