"""The pipes of the process drawing: drafts become corner points, and everything gets a y."""

from __future__ import annotations

from dataclasses import dataclass, field

from clepsydra.report.flow_graph import Feed, Outlet, Split, leaves
from clepsydra.report.pipe_drafts import BOTTOM, Crossway, Draft, draft_pipes
from clepsydra.report.placement import TANK_HEIGHT, Placement, Riser

_TRACK = 20.0
_OUTLET_BAND = 46.0
_STUB_BAND = 58.0
_INLET_BAND = 26.0

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

    Examples
    --------
    >>> Pipe("tank_3", "outlet_3", "outlet_3 to tank_1", [(0.0, 0.0), (0.0, 40.0)]).points[-1]
    (0.0, 40.0)
    """

    source: str
    line: str
    title: str
    points: list[Point]


@dataclass
class Fitting:
    """A splitter: where it sits and the directions of its ports, of "up", "down", "left", "right".

    `shares` are (x, y, anchor, share): the share of the flow written beside each port.

    Examples
    --------
    >>> valve = Split("valve", ((0.7, "tank_1"), (0.3, "tank_4")))
    >>> sorted(Fitting(valve, 0.0, 0.0, {"down", "right", "up"}, "pump_1", -1).ports)
    ['down', 'right', 'up']
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

    Examples
    --------
    >>> Routes(tops={"tank_1": 60.0}).tops["tank_1"]
    60.0
    """

    pipes: list[Pipe] = field(default_factory=list)
    fittings: list[Fitting] = field(default_factory=list)
    orifices: list[tuple[Outlet, float, float, int]] = field(default_factory=list)
    stubs: list[tuple[Feed, float, float]] = field(default_factory=list)
    tops: dict[str, float] = field(default_factory=dict)
    pump_y: float = 0.0
    basin_y: float = 0.0
    basin_uses: list[tuple[float, str]] = field(default_factory=list)


def route(placement: Placement) -> Routes:
    """Find the way of every pipe and with it the height of everything.

    Examples
    --------
    >>> from clepsydra.report.flow_graph import FlowGraph
    >>> from clepsydra.report.placement import place
    >>> outlet, pump = Outlet("outlet", "tank", "basin"), Feed("pump", True, "basin", "tank")
    >>> routes = route(place(FlowGraph(("tank",), (outlet,), (pump,), ()), {"pump": ("pump",)}))
    >>> [pipe.title for pipe in routes.pipes]
    ['outlet to basin', 'pump to tank']
    """
    router = _Router(placement)
    router.set_heights()
    router.draw()
    return router.routes


class _Router:
    def __init__(self, placement: Placement) -> None:
        self.placement = placement
        self.drafts = draft_pipes(placement)
        self.routes = Routes()
        self.bottoms: dict[int, float] = {}

    def set_heights(self) -> None:
        """Stack channels and tanks from the top down."""
        layer = self.placement.layer
        y = 8.0
        for level in range(max(layer.values()), -1, -1):
            stubs = any(layer[tank] == level for _, tank, _ in self.drafts.stub_ports)
            y += _TRACK * self.drafts.tracks.get(level, 0) + (_STUB_BAND if stubs else _INLET_BAND)
            self.bottoms[level] = y - (_STUB_BAND if stubs else _INLET_BAND)
            for tank in self.placement.graph.tanks:
                if layer[tank] == level:
                    self.routes.tops[tank] = y
            y += TANK_HEIGHT + _OUTLET_BAND
        y += _TRACK * self.drafts.tracks.get(BOTTOM, 0)
        self.bottoms[BOTTOM] = y
        pumps = any(riser.name == riser.feed.name for riser in self.placement.risers)
        # A splitter just above the pumps needs room for its name.
        self.routes.pump_y = y + (48.0 if BOTTOM in self.drafts.tracks else 34.0)
        self.routes.basin_y = self.routes.pump_y + 50.0 if pumps else y + 10.0

    def _height(self, way: Crossway) -> float:
        return self.bottoms[way.channel] - _TRACK * way.track

    def draw(self) -> None:
        """Turn drafts into pipes."""
        self._draw_outlets()
        self._draw_risers()
        for feed, tank, x in self.drafts.stub_ports:
            top = self.routes.tops[tank]
            self.routes.stubs.append((feed, x, top - 28.0))
            title = f"{feed.name} to {tank}"
            self.routes.pipes.append(
                Pipe(feed.name, feed.name, title, [(x, top - 28.0), (x, top + 3.0)])
            )

    def _end(self, draft: Draft) -> float:
        if draft.receiver in self.routes.tops:
            return self.routes.tops[draft.receiver] + 3.0
        self.routes.basin_uses.append((draft.end, draft.receiver))
        return self.routes.basin_y

    def _points(self, draft: Draft, first: Point) -> list[Point]:
        points = [first]
        for way in draft.crossways:
            y = self._height(way)
            points += [(points[-1][0], y), (way.stop, y)]
        points.append((draft.end, self._end(draft)))
        return points

    def _draw_outlets(self) -> None:
        routes = self.routes
        for outlet in self.placement.graph.outlets:
            own = [draft for entry, draft in self.drafts.drains if entry is outlet]
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
        self, outlet: Outlet, split: Split, own: list[Draft], side: int
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
            if place in self.drafts.joints and riser.parent is not None:
                y = self._height(self.drafts.joints[place])
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
            own = [(share, draft) for owner, share, draft in self.drafts.rises if owner is riser]
            for _, draft in own:
                first = (riser.x, feet[id(riser)])
                routes.pipes.append(
                    Pipe(draft.source, draft.line, draft.title, self._points(draft, first))
                )
            if riser.split is not None:
                self._fit_splitter(riser, own)

    def _fit_splitter(self, riser: Riser, own: list[tuple[float | None, Draft]]) -> None:
        """Set a splitter where the first pipe leaves its riser, and write the shares."""
        assert riser.split is not None
        exits = [
            (self._height(draft.crossways[0]), draft.end, share or 0.0) for share, draft in own
        ]
        children = {entry.split.name: entry for entry in self.placement.risers if entry.split}
        for share, branch in riser.split.branches:
            if isinstance(branch, Split):
                child = children[branch.name]
                joint = self.drafts.joints[self.placement.risers.index(child)]
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
