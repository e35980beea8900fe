"""Which part of a control scheme moves which: names resolved, and every wrong way refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.process.table_reader import TableReader
from clepsydra.studies.file.gains import read_gain
from clepsydra.studies.file.joined_unit import unit_of_gain
from clepsydra.studies.file.scheme_parts import (
    Feedforward,
    Loop,
    Ratio,
    SchemeParts,
    Selector,
    Split,
)

_SETPOINT = ".setpoint"


class Way(NamedTuple):
    """One way of a signal: from a part to another, or to a manipulated variable.

    Parameters
    ----------
    source, target : str
        "loop level", "selector lowest", "split inlets", "ratio acid" or "output outflow".
    table, key : TableReader, str
        Where it was written.
    part : int
        Of a split range, from 0.

    Examples
    --------
    >>> Way("loop level", "output outflow", None, "output").part
    0
    """

    source: str
    target: str
    table: TableReader
    key: str
    part: int = 0


@dataclass
class Wiring:
    """The ways of all signals of a scheme, checked.

    Parameters
    ----------
    parts : SchemeParts

    Raises
    ------
    InputError
        A name is unknown or stands for two things; something is moved twice; a loop, split or
        ratio lacks what it needs; a selector has fewer than two sources; a fixed setpoint is moved;
        the signals run in a circle; nothing moves an output.

    Examples
    --------
    See `clepsydra.studies.file.scheme.read_scheme`.
    """

    parts: SchemeParts
    ways: list[Way] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._by_name = {
            **{f"loop {loop.name}": loop for loop in self.parts.loops},
            **{f"selector {each.name}": each for each in self.parts.selectors},
            **{f"split {each.name}": each for each in self.parts.splits},
            **{f"ratio {each.name}": each for each in self.parts.ratios},
        }
        self._check_names()
        self.ways = list(self._written())
        self._check_taken_once()
        self._check_circles()
        self._check_sources()
        self.feedforward = self._feedforward()
        if not self.outputs:
            raise self.parts.table.refused(
                "outputs", "nothing", "a loop that moves a manipulated variable", "add one"
            )

    @property
    def outputs(self) -> list[str]:
        """The manipulated variables that the scheme moves, in the order of the process."""
        moved = {way.target for way in self.ways}
        return [u.name for u in self.parts.process.inputs if f"output {u.name}" in moved]

    def sources(self, target: str) -> list[Way]:
        """Return the ways that lead to a part or an output."""
        return [way for way in self.ways if way.target == target]

    def outer(self, loop: Loop) -> str | None:
        """Return the part that gives the setpoint of a loop; None where the operator does."""
        ways = self.sources(f"loop {loop.name}")
        return ways[0].source if ways else None

    def moved_by(self, source: str, part: int = 0) -> Signal:
        """Return the signal that a part moves: it lends unit and range."""
        way = [each for each in self.ways if each.source == source][part]
        return self._signal_at(way.target)

    def _signal_at(self, target: str) -> Signal:
        if target.startswith("output "):
            return self.parts.process.signal(target.removeprefix("output "))
        part = self._by_name[target]
        if isinstance(part, Loop):
            return part.measurement
        if isinstance(part, Split):
            return Signal(f"{part.name}", "%", low=0.0, high=100.0)
        if isinstance(part, Ratio):
            return self._ratio(part, target)
        return self.moved_by(target)

    def _ratio(self, part: Ratio, target: str) -> Signal:
        """Return the ratio that a loop trims, with its limits as range."""
        moved = self.moved_by(target)
        low, high = (
            read_gain(
                part.table, key, moved, part.wild,
                expected="a ratio", remedy="give the ends between which the loop may trim it",
            )
            for key in ("lowest_ratio", "highest_ratio")
        )  # fmt: skip
        if not low < high:
            raise part.table.refused(
                "lowest_ratio",
                part.table.written("lowest_ratio"),
                "a lowest ratio below the highest",
                "exchange or correct them",
            )
        return Signal(part.name, unit_of_gain(moved, part.wild), low=low, high=high)

    def _check_names(self) -> None:
        inputs = {signal.name for signal in self.parts.process.inputs}
        seen: dict[str, str] = {}
        blocks: tuple[Selector | Split | Ratio, ...] = (
            *self.parts.selectors,
            *self.parts.splits,
            *self.parts.ratios,
        )
        for each in blocks:
            if each.name in inputs or each.name in seen:
                other = "a manipulated variable" if each.name in inputs else seen[each.name]
                kind = type(each).__name__.lower()
                raise self.parts.table.refused(
                    f"{kind}s" if kind != "split" else "split_ranges",
                    each.name,
                    f"a name of its own for each part; {each.name} is {other} as well",
                    f"rename it, for example to {each.name}_{kind}",
                )
            seen[each.name] = f"a {type(each).__name__.lower()}"

    def _written(self) -> Iterator[Way]:
        for loop in self.parts.loops:
            yield self._way(f"loop {loop.name}", loop.table, loop.output)
        for selector in self.parts.selectors:
            yield self._way(f"selector {selector.name}", selector.table, selector.output)
        for ratio in self.parts.ratios:
            yield self._way(f"ratio {ratio.name}", ratio.table, ratio.output)
        for split in self.parts.splits:
            for number, part in enumerate(split.parts):
                way = self._way(f"split {split.name}", part.table, part.output)
                yield way._replace(part=number)

    def _way(self, source: str, table: TableReader, written: str) -> Way:
        inputs = [signal.name for signal in self.parts.process.inputs]
        if written in inputs:
            return Way(source, f"output {written}", table, "output")
        if written.endswith(_SETPOINT):
            loop = written.removesuffix(_SETPOINT)
            if f"loop {loop}" in self._by_name:
                return Way(source, f"loop {loop}", table, "output")
            raise table.refused(
                "output",
                written,
                f"the setpoint of a loop of this scheme "
                f"({', '.join(each.name + _SETPOINT for each in self.parts.loops)}): a cascade "
                "needs an inner loop with a measurement of its own",
                f"add a table loops.{loop} with its measurement, or move something else",
            )
        kinds = ("selector", "split", "ratio")
        for kind in kinds:
            if f"{kind} {written}" in self._by_name:
                return Way(source, f"{kind} {written}", table, "output")
        known = [name.split(" ", 1)[1] for name in self._by_name if not name.startswith("loop ")]
        cascade = [each.name + _SETPOINT for each in self.parts.loops]
        if written in (each.name for each in self.parts.loops):
            remedy = f'write "{written}{_SETPOINT}" for a cascade'
        else:
            remedy = suggestion(written, [*inputs, *known, *cascade], "correct the name")
        raise table.refused(
            "output",
            written[:60],
            f"a manipulated variable ({', '.join(inputs)}), a selector, a split range or a ratio "
            f"({', '.join(known) or 'none here'}), or the setpoint of another loop",
            remedy,
        )

    def _check_taken_once(self) -> None:
        for way in self.ways:
            first = self.sources(way.target)[0]
            if way.target.startswith("selector ") or first is way:
                continue
            what = way.target.split(" ", 1)[1]
            what += _SETPOINT if way.target.startswith("loop ") else ""
            raise way.table.refused(
                way.key,
                what,
                f"something of its own to move: {first.source} moves {what} already",
                "put a selector between the two, or a split range with a loop for each",
            )

    def _check_sources(self) -> None:
        for loop in self.parts.loops:
            outer = self.outer(loop)
            if outer is not None and loop.table.has("setpoint"):
                raise loop.table.refused(
                    "setpoint",
                    loop.table.written("setpoint"),
                    f"no setpoint: {outer} gives it",
                    "leave it out, or let that loop move something else",
                )
            if outer is not None and loop.form.remote_setpoint:
                raise loop.table.refused(
                    "remote_setpoint", "true", f"no remote setpoint: {outer} gives it", "remove it"
                )
            if outer is None and loop.setpoint is None:
                self._check_operator(loop)
        for selector in self.parts.selectors:
            ways = self.sources(f"selector {selector.name}")
            if len(ways) < 2:
                raise selector.table.refused(
                    "select",
                    f"{len(ways)} loops",
                    f'two or more parts that have output = "{selector.name}"',
                    "let another loop move it, or leave the selector out",
                )
        for split in self.parts.splits:
            if not self.sources(f"split {split.name}"):
                raise split.table.refused(
                    "parts",
                    "nothing that moves it",
                    f'a loop that has output = "{split.name}"',
                    "let one move it, or leave the split range out",
                )
        for ratio in self.parts.ratios:
            trimmed = bool(self.sources(f"ratio {ratio.name}"))
            wrong = ("ratio",) if trimmed else ("lowest_ratio", "highest_ratio")
            for key in wrong:
                if ratio.table.has(key):
                    raise ratio.table.refused(
                        key,
                        ratio.table.written(key),
                        "lowest_ratio and highest_ratio, since a loop trims it"
                        if trimmed
                        else "ratio alone, since no loop trims it",
                        "remove it",
                    )

    def _check_operator(self, loop: Loop) -> None:
        controlled = self.parts.process.controlled
        if loop.measurement.name not in controlled:
            raise loop.table.refused(
                "setpoint",
                "operator" if loop.table.has("setpoint") else "no setpoint",
                f"a value, since {loop.measurement.name} is none of the controlled measurements "
                f"({', '.join(controlled)}), whose setpoints the operator gives",
                f"write it with its unit, in {loop.measurement.shown_unit}, or let another loop "
                "move it",
            )

    def _check_circles(self) -> None:
        for start in self.ways:
            circle = self._way_back([start.source], start.target)
            if circle:
                raise start.table.refused(
                    start.key,
                    " → ".join(each.split(" ", 1)[1] for each in circle),
                    "a way from setpoints to manipulated variables without a circle",
                    "let one of them move something else",
                )

    def _way_back(self, passed: list[str], target: str) -> list[str]:
        """Return the parts from the first one back to it; none where it is not reached."""
        if target in passed:
            return [*passed, target] if target == passed[0] else []
        for way in self.ways:
            if way.source == target and (found := self._way_back([*passed, target], way.target)):
                return found
        return []

    def _feedforward(self) -> dict[str, list[Feedforward]]:
        """Return the terms that are added to each part."""
        found: dict[str, list[Feedforward]] = {}
        names = {
            name.split(" ", 1)[1]: name for name in self._by_name if not name.startswith("split ")
        }
        names |= {each.name: f"loop {each.name}" for each in self.parts.loops}
        for each in self.parts.feedforwards:
            if each.to not in names:
                raise each.table.refused(
                    "to",
                    each.to[:60],
                    f"a loop, selector or ratio of this scheme ({', '.join(names)})",
                    suggestion(each.to, names, "choose one of them"),
                )
            found.setdefault(names[each.to], []).append(each)
        return found
