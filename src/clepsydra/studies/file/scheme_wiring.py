"""Which part of a control scheme moves which: names resolved, and every wrong way refused."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from clepsydra.base.errors import Finding
from clepsydra.base.signal import Signal, path
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.structure.law import in_order
from clepsydra.process.errors_at import errors_at
from clepsydra.process.joined_unit import unit_of_gain
from clepsydra.process.known_names import known_name
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.scheme_parts import (
    Feedforward,
    Loop,
    Part,
    Ratio,
    SchemeParts,
    Selector,
    Split,
)


class Way(NamedTuple):
    """One way of a signal: from a part to another, or to a manipulated variable.

    Parameters
    ----------
    source, target : str
        "loop level", "selector lowest", "split inlets", "ratio acid" or "output outflow".
    table : TableReader
        Where it was written, as `output`.
    """

    source: str
    target: str
    table: TableReader


class Wiring:
    """The ways of all signals of a scheme, checked.

    Attributes
    ----------
    ways : list of Way
    outputs : list of str
        The manipulated variables that the scheme moves, in the order of the process.
    feedforward : dict
        Part to the terms that are added to it.

    Raises
    ------
    InputError
        A name is unknown or stands for two things; something is moved twice; a loop, split or
        ratio lacks what it needs; a selector has fewer than two sources; a fixed setpoint is moved;
        the signals run in a circle; nothing moves an output.
    """

    def __init__(self, parts: SchemeParts) -> None:
        self.parts = parts
        moving = (*parts.loops, *parts.selectors, *parts.ratios, *parts.split_ranges)
        self._by_label: dict[str, Part] = {part.label: part for part in moving}
        self._check_names()
        self.ways = [
            Way(part.label, self._target(table, written), table)
            for part in moving
            for table, written in part.moves
        ]
        self._check_taken_once()
        self._check_circles()
        for part in moving:
            self._check_sources(part)
        self.feedforward = self._feedforward()
        moved = {way.target for way in self.ways}
        self.outputs = [u.name for u in parts.process.inputs if f"output {u.name}" in moved]
        if not self.outputs:
            raise parts.table.refused(
                "outputs", "nothing", "a loop that moves a manipulated variable", "add one"
            )

    def sources(self, target: str) -> list[Way]:
        """Return the ways that lead to a part or an output."""
        return [way for way in self.ways if way.target == target]

    def outer(self, loop: Loop) -> str | None:
        """Return the part that gives the setpoint of a loop; None where the operator does."""
        return next((way.source for way in self.sources(loop.label)), None)

    def moved_by(self, source: str) -> list[Signal]:
        """Return the signals that a part moves: they lend unit and range."""
        return [self.signal_at(way.target) for way in self.ways if way.source == source]

    def signal_at(self, target: str) -> Signal:
        """Return the signal of a part or an output that is moved."""
        if target not in self._by_label:
            return self.parts.process.signal(target.removeprefix("output "))
        part = self._by_label[target]
        if isinstance(part, Loop):
            return part.measurement
        if isinstance(part, Split):
            return Signal(part.name, "%", low=0.0, high=100.0)
        (moved,) = self.moved_by(target)
        return self._ratio(part, moved) if isinstance(part, Ratio) else moved

    def _ratio(self, part: Ratio, moved: Signal) -> Signal:
        """Return the ratio that a loop trims, with its limits as range."""
        low, high = part.lowest_ratio(moved, part.wild), part.highest_ratio(moved, part.wild)
        if not low < high:
            raise part.table.wrong(
                "lowest_ratio", "a lowest ratio below the highest", "exchange or correct them"
            )
        return Signal(part.name, unit_of_gain(moved, part.wild), low=low, high=high)

    def _joints(self) -> Iterator[Part]:
        """Yield what several parts of other kinds may move by its name: all but loops."""
        yield from (*self.parts.selectors, *self.parts.split_ranges, *self.parts.ratios)

    def _check_names(self) -> None:
        seen = {signal.name: "a manipulated variable" for signal in self.parts.process.inputs}
        for each in self._joints():
            if each.name in seen:
                raise self.parts.table.refused(
                    "split_ranges" if isinstance(each, Split) else f"{each.kind}s",
                    each.name,
                    f"a name of its own for each part; {each.name} is {seen[each.name]} as well",
                    f"rename it, for example to {each.name}_{each.kind}",
                )
            seen[each.name] = f"a {each.kind}"

    def _target(self, table: TableReader, written: str) -> str:
        """Return the label of what is written as an output."""
        inputs = {u.name: f"output {u.name}" for u in self.parts.process.inputs}
        joints = {each.name: each.label for each in self._joints()}
        cascades = {path(loop.name, "setpoint"): loop.label for loop in self.parts.loops}
        targets = joints | cascades | inputs
        if written in targets:
            return targets[written]
        loop, _, part = written.rpartition(".")
        if part == "setpoint":
            raise table.refused(
                "output",
                written,
                f"the setpoint of a loop of this scheme ({', '.join(cascades)}): a cascade "
                "needs an inner loop with a measurement of its own",
                f"add a table loops.{loop} with its measurement, or move something else",
            )
        cascade = path(written, "setpoint")
        raise table.refused(
            "output",
            written[:60],
            f"a manipulated variable ({', '.join(inputs)}), a selector, a split range or a ratio "
            f"({', '.join(joints) or 'none here'}), or the setpoint of another loop",
            f'write "{cascade}" for a cascade'
            if cascade in cascades
            else suggestion(written, [*inputs, *joints, *cascades], "correct the name"),
        )

    def _check_taken_once(self) -> None:
        first: dict[str, Way] = {}
        for way in self.ways:
            known = first.setdefault(way.target, way)
            target = self._by_label.get(way.target)
            if known is way or isinstance(target, Selector):
                continue
            what = way.target.partition(" ")[2] + (".setpoint" if isinstance(target, Loop) else "")
            raise way.table.refused(
                "output",
                what,
                f"something of its own to move: {known.source} moves {what} already",
                "put a selector between the two, or a split range with a loop for each",
            )

    def _check_circles(self) -> None:
        sources = {label: [way.source for way in self.sources(label)] for label in self._by_label}
        places = {way.source: way.table.place("output") for way in self.ways}
        with errors_at(self.parts.table, places):
            in_order("control scheme", sources)

    def _check_sources(self, part: Part) -> None:
        """Refuse a part that lacks what moves it, or has more than it can follow."""
        table, sources = part.table, self.sources(part.label)
        if isinstance(part, Loop):
            self._check_setpoint(part, sources[0].source if sources else None)
        elif isinstance(part, Selector) and len(sources) < 2:
            raise table.refused(
                "select",
                f"{len(sources)} loops",
                f'two or more parts that have output = "{part.name}"',
                "let another loop move it, or leave the selector out",
            )
        elif isinstance(part, Split) and not sources:
            raise table.refused(
                "parts",
                "nothing that moves it",
                f'a loop that has output = "{part.name}"',
                "let one move it, or leave the split range out",
            )
        elif isinstance(part, Ratio):
            expected = "ratio alone, since no loop trims it"
            if sources:
                expected = "lowest_ratio and highest_ratio, since a loop trims it"
            for key in ("ratio",) if sources else ("lowest_ratio", "highest_ratio"):
                if table.has(key):
                    raise table.wrong(key, expected, "remove it")

    def _check_setpoint(self, loop: Loop, outer: str | None) -> None:
        table, controlled = loop.table, self.parts.process.controlled
        if outer is not None and table.has("setpoint"):
            raise table.wrong(
                "setpoint",
                f"no setpoint: {outer} gives it",
                "leave it out, or let that loop move something else",
            )
        if outer is not None and loop.form.remote_setpoint:
            raise table.refused(
                "remote_setpoint", "true", f"no remote setpoint: {outer} gives it", "remove it"
            )
        if outer is None and loop.setpoint is None and loop.measurement.name not in controlled:
            raise table.refused(
                "setpoint",
                "operator" if table.has("setpoint") else Finding("no setpoint"),
                f"a value, since {loop.measurement.name} is none of the controlled measurements "
                f"({', '.join(controlled)}), whose setpoints the operator gives",
                f"write it with its unit, in {loop.measurement.shown_unit}, or let another loop "
                "move it",
            )

    def _feedforward(self) -> dict[str, list[Feedforward]]:
        """Return the terms that are added to each part."""
        found: dict[str, list[Feedforward]] = {}
        parts = self.parts
        names = {each.name: each.label for each in (*parts.selectors, *parts.ratios, *parts.loops)}
        for each in parts.feedforward:
            words = "a loop, selector or ratio of this scheme"
            to = known_name(each.table, "to", each.to, names, words)
            found.setdefault(names[to], []).append(each)
        return found
