"""The blocks of a control scheme and the numbers of their parameters."""

from __future__ import annotations

from clepsydra.base.signal import Signal, path
from clepsydra.base.units import from_si
from clepsydra.base.words import time_text
from clepsydra.controllers.pid_keys import GAINS
from clepsydra.controllers.structure.block import Block
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock
from clepsydra.designs.loops.words import gain
from clepsydra.designs.request import in_shown_unit
from clepsydra.process.joined_unit import BESIDE
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.file.law_parameters import check_law_range
from clepsydra.studies.file.pid_table import PidTable
from clepsydra.studies.file.scheme_parts import Feedforward, Loop, Ratio, SchemeParts, Split
from clepsydra.studies.file.scheme_wiring import Way, Wiring


class SchemeBlocks:
    """The blocks of a scheme; each owns its parameters by its name in the file.

    Attributes
    ----------
    blocks : list of Block
    values, places : dict
        Parameter of the law to its value, and to where it was written.
    at_point : dict
        Parameter to the signal whose value at the operating point it takes.
    fixed, follows : dict
        Free inputs of the law to their value, or to the signal whose value they take.
    assumed : list of str
    words : list of str
        What each loop does, for the reader.

    Raises
    ------
    InputError
        A number is missing or wrong.
    """

    def __init__(self, parts: SchemeParts, wiring: Wiring) -> None:
        self.parts, self.wiring = parts, wiring
        self.blocks: list[Block] = []
        self.values: dict[str, float] = {}
        self.places: dict[str, str] = {}
        self.at_point: dict[str, str] = {}
        self.fixed: dict[str, float] = {}
        self.follows: dict[str, str] = {}
        self.assumed: list[str] = []
        self.words: list[str] = []
        self._measured = self._all_measured()
        self._setpoints = self._all_setpoints()
        for loop in parts.loops:
            self._add_loop(loop)
        for selector in parts.selectors:
            name = selector.label
            self.blocks.append(SelectorBlock(name, self._ports(name), selector.select))
        for split in parts.split_ranges:
            self._add_split(split)
        for ratio in parts.ratios:
            self._add_ratio(ratio)
        for target, terms in wiring.feedforward.items():
            self._add_feedforward(target, terms)
        for name in wiring.outputs:
            self._add_output(parts.process.signal(name))

    @property
    def measurements(self) -> tuple[str, ...]:
        """The sensors of the scheme."""
        return tuple(self._measured)

    @property
    def setpoints(self) -> tuple[str, ...]:
        """The measurements whose setpoints the operator gives."""
        return tuple(name for name in self._setpoints if path(name, "sp") not in self.fixed)

    def law(self, name: str) -> StepLaw:
        """Return the step law, named after the controller."""
        words = "".join(c if c.isascii() and c.isalnum() else "_" for c in name.lower())
        identifier = "_".join(word for word in words.split("_") if word)[:40].strip("_")
        return structure_law(
            f"scheme_{identifier}" if identifier else "scheme",
            self.blocks,
            setpoints=self._setpoints,
            measured=list(self._measured.values()),
        )

    def _all_measured(self) -> dict[str, Signal]:
        parts = self.parts
        found = {loop.measurement.name: loop.measurement for loop in parts.loops}
        found |= {ratio.wild.name: ratio.wild for ratio in parts.ratios}
        return found | {each.signal.name: each.signal for each in parts.feedforward}

    def _all_setpoints(self) -> dict[str, Signal]:
        """Return what the setpoints that no loop gives belong to: the operator's come first.

        The operator's belongs to the measurement, a fixed one to its loop.
        """
        free = [loop for loop in self.parts.loops if self.wiring.outer(loop) is None]
        found = {loop.measurement.name: loop.measurement for loop in free if loop.setpoint is None}
        for loop in (each for each in free if each.setpoint is not None):
            if loop.name in found:
                raise self.parts.table.refused(
                    "loops",
                    loop.name,
                    f"another name for a loop with a fixed setpoint: {loop.name} is the setpoint "
                    "that the operator gives",
                    f"rename it, for example to {loop.name}_fixed",
                )
            found[loop.name] = loop.measurement
        return found

    def _ports(self, target: str) -> tuple[str, ...]:
        """Return the ports whose values lead to a block or an output."""
        return tuple(self._port(way) for way in self.wiring.sources(target))

    def _port(self, way: Way) -> str:
        if way.source.startswith("split "):
            return f"{way.source}, {self.wiring.signal_at(way.target).name}"
        if way.source in self.wiring.feedforward:
            return _with_feedforward(way.source)
        return way.source

    def _add_loop(self, loop: Loop) -> None:
        name, wiring = loop.label, self.wiring
        (way,) = (each for each in wiring.ways if each.source == name)
        outer = self._ports(name)
        own = path(loop.measurement if loop.setpoint is None else loop.name, "sp")
        if loop.setpoint is not None:
            self.fixed[own] = loop.setpoint
        if outer:
            self.follows[path(loop.name, "local_setpoint")] = loop.measurement.name
            self.fixed[path(loop.name, "setpoint_source")] = 1.0
        if loop.form.remote_setpoint:
            self.follows[path(loop.name, "remote_setpoint")] = loop.measurement.name
            self.fixed[path(loop.name, "setpoint_source")] = 0.0
        block = PidBlock(
            name,
            loop.name,
            loop.form,
            loop.measurement,
            wiring.signal_at(way.target),
            outer[0] if outer else own,
            inner=bool(outer),
            direct=way.target.startswith("output ") and name not in wiring.feedforward,
        )
        self.blocks.append(block)
        read = PidTable(loop.settings, block)
        self.values |= read.values
        self.places |= read.places | {name: loop.table.place("anti_windup")}
        self.assumed += [f"{loop.name}.{each}" for each in read.assumed]
        self.words.append(_words(loop, block, read.values))

    def _add_split(self, split: Split) -> None:
        legs = []
        signals = self.wiring.moved_by(split.label)
        for moved, leg in zip(signals, split.legs, strict=True):
            ends = leg.at_from(moved), leg.at_to(moved)
            legs.append(Leg(path(split.name, moved.name), moved, *leg.span, *ends))
        self.blocks.append(SplitRangeBlock(split.label, self._ports(split.label)[0], tuple(legs)))

    def _add_ratio(self, ratio: Ratio) -> None:
        (moved,) = self.wiring.moved_by(ratio.label)
        source = next(iter(self._ports(ratio.label)), None)
        self.blocks.append(RatioBlock(ratio.label, ratio.name, ratio.wild, moved, source))
        for key in ("ratio",) if source is None else ("lowest_ratio", "highest_ratio"):
            value = getattr(ratio, key)(moved, ratio.wild)
            self._put(path(ratio.name, key), value, ratio.table, key)

    def _add_feedforward(self, target: str, added: list[Feedforward]) -> None:
        (moved,) = self.wiring.moved_by(target)
        terms = [
            FeedforwardTerm(
                _owner(each), moved, each.signal, measured=True, dynamic=each.lead is not None
            )
            for each in added
        ]
        name = _with_feedforward(target)
        self.blocks.append(FeedforwardBlock(name, target, moved, tuple(terms)))
        for each in added:
            self._add_term(each, moved)

    def _add_term(self, term: Feedforward, moved: Signal) -> None:
        found = {"gain": term.gain(moved, term.signal)}
        if term.lead is not None and term.lag is not None:
            found |= {"lead": term.lead, "lag": term.lag}
        if term.reference is not None:
            found["reference"] = term.reference(term.signal)
        else:
            self.at_point[path(_owner(term), "reference")] = term.signal.name
        for key, value in found.items():
            self._put(path(_owner(term), key), value, term.table, key)

    def _add_output(self, signal: Signal) -> None:
        written = next((o for o in self.parts.outputs if o.name == signal.name), None)
        limited = written is not None and written.rate_limit is not None
        self.blocks.append(OutputBlock(signal, self._ports(f"output {signal.name}")[0], limited))
        if written is None:
            return
        table, ends = written.table, {"low": signal.low, "high": signal.high}
        for key, limit in (("low", written.low), ("high", written.high)):
            if limit is not None:
                ends[key] = limit(signal)
                self._put(path(signal, f"{key}_limit"), ends[key], table, key)
        if not ends["low"] < ends["high"]:
            key, side, other = (
                ("low", "below", "high") if table.has("low") else ("high", "above", "low")
            )
            end = f"the {other} end of its range" if not table.has(other) else f"its {other} limit"
            raise table.wrong(
                key,
                f"a limit of {signal.name} {side} {end}, {in_shown_unit(signal, ends[other])}",
                "exchange the two or widen them",
            )
        if written.rate_limit is not None:
            self._put(path(signal, "rate_limit"), written.rate_limit(signal), table, "rate_limit")

    def _put(self, parameter: str, value: float, table: TableReader, key: str) -> None:
        (signal,) = (each for each in self.blocks[-1].parameters() if each.name == parameter)
        check_law_range(table, key, signal, value)
        self.values[parameter] = value
        self.places[parameter] = table.place(key)


def _with_feedforward(source: str) -> str:
    return f"{source} with feedforward"


def _owner(term: Feedforward) -> str:
    """Return what a term's parameters belong to: its table in the file."""
    return path("feedforward", term.name)


def _words(loop: Loop, block: PidBlock, values: dict[str, float]) -> str:
    """Return what a loop does as a phrase."""
    form, signals, ((_, output),) = loop.form, (block.measurement, block.moved), loop.moves
    units = [signal.shown_unit for signal in signals]
    said = []
    for name, (key, time) in zip(("K", "Ki", "Kd"), GAINS.items(), strict=True):
        value = values.get(path(loop.name, key))
        if value is None:
            continue
        if all(signal.has_range for signal in signals):
            said.append(f"{name} = {gain(value, *signals)}{BESIDE[time]}")
        else:
            shown = value * from_si(1.0, block.moved.unit, units[1])
            shown /= from_si(1.0, block.measurement.unit, units[0])
            said.append(f"{name} = {shown:.3g} ({units[1]})/({units[0]}){BESIDE[time]}")
    for name, key in (("Ti", "integral_time"), ("Td", "derivative_time")):
        if (parameter := path(loop.name, key)) in values:
            said.append(f"{name} = {time_text(values[parameter])}")
    if loop.setpoint is not None:
        said.append(f"setpoint {in_shown_unit(loop.measurement, loop.setpoint)}")
    return f"{loop.name}: {loop.measurement.name} by {output}, {form.actions}, {', '.join(said)}"
