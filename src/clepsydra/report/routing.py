"""The pipes of the process drawing: orthogonal, each on its own track between the tanks."""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.report.flow_graph import Feed, Outlet, Split, leaves
from clepsydra.report.placement import TANK_HEIGHT, TANK_WIDTH, Placement, Riser

_TRACK = 20.0
_OUTLET_BAND = 46.0
_STUB_BAND = 58.0
_INLET_BAND = 26.0
#: Channel below the lowest tanks.
BOTTOM = -1

Point = tuple[float, float]


@dataclass(eq=False)
class Pipe:
    """A pipe as its corner points, from source to end.

    Parameters
    ----------
    source : str
        The pump, inflow or tank that the liquid comes from.
    line : str
        Pipes of one line run together before they part, so they may overlap.
    title : str
        For readers who do not see the picture.
    points : list of (x, y)
    """

    source: str
    line: str
    title: str
    points: list[Point]


@dataclass
class Fitting:
    """A splitter: where it sits and the directions of its ports, of "up", "down", "left", "right".

    `shares` are (x, y, anchor, share): the share of the flow written beside each port.
    """

    split: Split
    x: float
    y: float
    ports: set[str]
    source: str
    outward: int
    shares: list[tuple[float, float, str, float]] = field(default_factory=list)


@dataclass
class Routes:
    """Everything that has a y as well.

    Parameters
    ----------
    pipes : list of Pipe
    fittings : list of Fitting
    orifices : list of (outlet, x, y, side)
        Side is -1 or +1, where its name stands.
    stubs : list of (inflow, x, y)
        Where the arrow of an inflow starts.
    tops : dict
        Tank to the y of its rim.
    pump_y, basin_y : float
        Centres of the pumps; surface of the reservoirs.
    basin_uses : list of (x, reservoir)
    """

    pipes: list[Pipe] = field(default_factory=list)
    fittings: list[Fitting] = field(default_factory=list)
    orifices: list[tuple[Outlet, float, float, int]] = field(default_factory=list)
    stubs: list[tuple[Feed, float, float]] = field(default_factory=list)
    tops: dict[str, float] = field(default_factory=dict)
    pump_y: float = 0.0
    basin_y: float = 0.0
    basin_uses: list[tuple[float, str]] = field(default_factory=list)


@dataclass
class _Crossway:
    """A horizontal stretch of a pipe; its track in the channel is found last."""

    channel: int
    start: float
    stop: float
    track: int = 0


@dataclass
class _Draft:
    """A pipe before its heights are known: x of its start, then crossways, then its end."""

    source: str
    line: str
    title: str
    start: float
    crossways: list[_Crossway]
    receiver: str
    end: float = 0.0


def route(placement: Placement) -> Routes:
    """Find the way of every pipe and with it the height of everything."""
    router = _Router(placement)
    router.draft_outlets()
    router.draft_risers()
    router.assign_ports()
    router.assign_tracks()
    router.set_heights()
    router.draw()
    return router.routes


class _Router:
    def __init__(self, placement: Placement) -> None:
        self.placement = placement
        self.routes = Routes()
        self.drains: list[tuple[Outlet, _Draft]] = []
        self.rises: list[tuple[Riser, float | None, _Draft]] = []
        self.joints: dict[int, _Crossway] = {}
        self.stub_ports: list[tuple[Feed, str, float]] = []
        self.bottoms: dict[int, float] = {}

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
        draft = _Draft(
            outlet.source, outlet.name, f"{outlet.name} to {receiver}", x, [], receiver, x
        )
        self.drains.append((outlet, draft))
        if placement.falls_straight(outlet, receiver):
            return
        passing = placement.downcomers.get((outlet.name, receiver))
        if passing is not None:
            draft.crossways.append(_Crossway(below, x, passing))
            x = passing
        if receiver in placement.layer:
            draft.crossways.append(_Crossway(placement.layer[receiver], x, x))
        else:
            draft.end = x

    def draft_risers(self) -> None:
        """Send each riser up to the tanks that it feeds, and join risers to their parents."""
        for place, riser in enumerate(self.placement.risers):
            if riser.parent is not None:
                self.joints[place] = _Crossway(BOTTOM, riser.x, riser.parent.x)
            for share, receiver in riser.targets:
                channel = self.placement.layer.get(receiver, BOTTOM)
                crossway = _Crossway(channel, riser.x, riser.x)
                title = f"{riser.feed.name} to {receiver}"
                draft = _Draft(riser.feed.name, riser.name, title, riser.x, [crossway], receiver)
                if channel == BOTTOM:
                    draft.end = crossway.stop = riser.x + 24.0 * riser.outward
                self.rises.append((riser, share, draft))

    def assign_ports(self) -> None:
        """Spread what enters a tank over its width, in the order in which it arrives."""
        placement = self.placement
        drafts = [draft for _, draft in self.drains] + [draft for _, _, draft in self.rises]
        for tank in placement.graph.tanks:
            centre = placement.centre[tank]
            left: list[tuple[float, _Draft | Feed]] = []
            right: list[tuple[float, _Draft | Feed]] = []
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
                        self.stub_ports.append((arrival, tank, port))
                    else:
                        arrival.end = arrival.crossways[-1].stop = port

    def assign_tracks(self) -> None:
        """Give crossways of a channel tracks, short ones lowest, so that few pipes cross."""
        crossways = [way for _, draft in self.drains for way in draft.crossways]
        crossways += [way for _, _, draft in self.rises for way in draft.crossways]
        crossways += list(self.joints.values())
        taken: dict[tuple[int, int], list[tuple[float, float]]] = {}
        for way in sorted(crossways, key=lambda way: abs(way.stop - way.start)):
            low, high = sorted((way.start, way.stop))
            while any(
                low < end + 12.0 and start - 12.0 < high
                for start, end in taken.get((way.channel, way.track), [])
            ):
                way.track += 1
            taken.setdefault((way.channel, way.track), []).append((low, high))
        self.tracks = {
            channel: 1 + max(way.track for way in crossways if way.channel == channel)
            for channel in {way.channel for way in crossways}
        }

    def set_heights(self) -> None:
        """Stack channels and tanks from the top down."""
        layer = self.placement.layer
        y = 8.0
        for level in range(max(layer.values()), -1, -1):
            stubs = any(layer[tank] == level for _, tank, _ in self.stub_ports)
            y += _TRACK * self.tracks.get(level, 0) + (_STUB_BAND if stubs else _INLET_BAND)
            self.bottoms[level] = y - (_STUB_BAND if stubs else _INLET_BAND)
            for tank in self.placement.graph.tanks:
                if layer[tank] == level:
                    self.routes.tops[tank] = y
            y += TANK_HEIGHT + _OUTLET_BAND
        y += _TRACK * self.tracks.get(BOTTOM, 0)
        self.bottoms[BOTTOM] = y
        pumps = any(riser.name == riser.feed.name for riser in self.placement.risers)
        # A splitter just above the pumps needs room for its name.
        self.routes.pump_y = y + (48.0 if BOTTOM in self.tracks else 34.0)
        self.routes.basin_y = self.routes.pump_y + 50.0 if pumps else y + 10.0

    def _height(self, way: _Crossway) -> float:
        return self.bottoms[way.channel] - _TRACK * way.track

    def draw(self) -> None:
        """Turn drafts into pipes."""
        self._draw_outlets()
        self._draw_risers()
        for feed, tank, x in self.stub_ports:
            top = self.routes.tops[tank]
            self.routes.stubs.append((feed, x, top - 28.0))
            title = f"{feed.name} to {tank}"
            self.routes.pipes.append(
                Pipe(feed.name, feed.name, title, [(x, top - 28.0), (x, top + 3.0)])
            )

    def _end(self, draft: _Draft) -> float:
        if draft.receiver in self.routes.tops:
            return self.routes.tops[draft.receiver] + 3.0
        self.routes.basin_uses.append((draft.end, draft.receiver))
        return self.routes.basin_y

    def _points(self, draft: _Draft, first: Point) -> list[Point]:
        points = [first]
        for way in draft.crossways:
            y = self._height(way)
            points += [(points[-1][0], y), (way.stop, y)]
        points.append((draft.end, self._end(draft)))
        return points

    def _draw_outlets(self) -> None:
        routes = self.routes
        for outlet in self.placement.graph.outlets:
            own = [draft for entry, draft in self.drains if entry is outlet]
            floor = routes.tops[outlet.source] + TANK_HEIGHT
            x = own[0].start
            for draft in own:
                points = self._points(draft, (x, floor))
                routes.pipes.append(Pipe(draft.source, draft.line, draft.title, points))
            side = 1 if x > self.placement.centre[outlet.source] else -1
            if x == self.placement.centre[outlet.source]:
                siblings = [e for e in self.placement.graph.outlets if e.source == outlet.source]
                side = -self.placement.sensor_side[outlet.source] if len(siblings) > 1 else 1
            routes.orifices.append((outlet, x, floor + 15.0, side))
            if isinstance(outlet.target, Split):
                self._fit_drain_splitter(outlet, outlet.target, own, side)

    def _fit_drain_splitter(
        self, outlet: Outlet, split: Split, own: list[_Draft], side: int
    ) -> None:
        """Set a splitter where the first branch leaves the pipe that falls from a tank."""
        turning = [draft for draft in own if draft.crossways]
        x, y = own[0].start, min(self._height(draft.crossways[0]) for draft in turning)
        fitting = Fitting(split, x, y, {"up"}, outlet.source, side)
        shares = dict(zip(leaves(split), _leaf_shares(split), strict=True))
        down = 0
        for draft in own:
            share = shares[draft.receiver]
            if draft.crossways and self._height(draft.crossways[0]) == y:
                right = draft.crossways[0].stop > x
                fitting.ports.add("right" if right else "left")
                beside, anchor = (x + 16.0, "start") if right else (x - 16.0, "end")
                fitting.shares.append((beside, y - 7.0, anchor, share))
            else:
                fitting.ports.add("down")
                fitting.shares.append((x - 8.0, y + 24.0 + 14.0 * down, "end", share))
                down += 1
        self.routes.fittings.append(fitting)

    def _draw_risers(self) -> None:
        routes = self.routes
        feet: dict[int, float] = {}
        for place, riser in enumerate(self.placement.risers):
            if riser.name == riser.feed.name:
                feet[id(riser)] = routes.pump_y
            if place in self.joints and riser.parent is not None:
                y = self._height(self.joints[place])
                if riser.name == riser.feed.name:
                    way = [(riser.x, routes.pump_y), (riser.x, y), (riser.parent.x, y)]
                else:
                    feet[id(riser)] = y
                    base = feet[id(riser.parent)]
                    way = [(riser.parent.x, base), (riser.parent.x, y), (riser.x, y)]
                routes.pipes.append(Pipe(riser.feed.name, riser.parent.name, riser.feed.name, way))
            if riser.feed.pumped and riser.name == riser.feed.name:
                routes.basin_uses.append((riser.x, riser.feed.source))
        for riser in self.placement.risers:
            own = [(share, draft) for owner, share, draft in self.rises if owner is riser]
            for _, draft in own:
                first = (riser.x, feet[id(riser)])
                routes.pipes.append(
                    Pipe(draft.source, draft.line, draft.title, self._points(draft, first))
                )
            if riser.split is not None:
                self._fit_splitter(riser, own)

    def _fit_splitter(self, riser: Riser, own: list[tuple[float | None, _Draft]]) -> None:
        """Set a splitter where the first pipe leaves its riser, and write the shares."""
        assert riser.split is not None
        exits = [
            (self._height(draft.crossways[0]), draft.end, share or 0.0) for share, draft in own
        ]
        children = {entry.split.name: entry for entry in self.placement.risers if entry.split}
        for share, branch in riser.split.branches:
            if isinstance(branch, Split):
                child = children[branch.name]
                joint = self.joints[self.placement.risers.index(child)]
                exits.append((self._height(joint), child.x, share))
        exits.sort(reverse=True)
        y = exits[0][0]
        fitting = Fitting(riser.split, riser.x, y, {"down"}, riser.feed.name, riser.outward)
        for height, end, share in exits:
            right = end > riser.x
            if height == y:
                fitting.ports.add("right" if right else "left")
                x = riser.x + (16.0 if right else -16.0)
                anchor = "start" if right else "end"
                fitting.shares.append((x, y - 7.0, anchor, share))
            else:
                fitting.ports.add("up")
                beside = riser.x + 6.0 * riser.outward
                anchor = "end" if riser.outward < 0 else "start"
                fitting.shares.append((beside, max(height + 14.0, y - 34.0), anchor, share))
        self.routes.fittings.append(fitting)


def _leaf_shares(target: str | Split, share: float = 1.0) -> list[float]:
    """Return the share of the whole flow that each of the `leaves` receives."""
    if isinstance(target, str):
        return [share]
    return [part for own, branch in target.branches for part in _leaf_shares(branch, share * own)]
