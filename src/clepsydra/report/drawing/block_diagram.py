"""What the calls of a program are wired to: the boxes of its picture and their wires."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

from clepsydra.base.signal import Signal
from clepsydra.program.entries import signal_of
from clepsydra.program.owned_state import RESTART, own_state
from clepsydra.program.program import Call, Program, read_by, written_by

#: Truth values that more boxes read than these are connected by name, not by a wire; and how many
#: columns further a wire reaches at most that carries none or a number.
_MOST_READERS, _REACH = 2, {False: 1, True: 3}
#: Columns that stand side by side; what leads into the next band of them is connected by name.
_BAND = 3


@dataclass(eq=False)
class Port:
    """A port of a box, and what it is connected to.

    Parameters
    ----------
    name : str
    box : int
        Place of its box.
    real : bool
        It carries a real number.
    wires : list of Port
        Outputs that are wired to this input.
    names : list of str
        What it is connected to by name.
    computed : bool
        Operations stand before it.
    """

    name: str
    box: int
    real: bool = True
    wires: list[Port] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    computed: bool = False


@dataclass(eq=False)
class Box:
    """A call of a block, or an output of the program that operations compute: that has no kind."""

    title: str
    kind: str = ""
    inputs: list[Port] = field(default_factory=list)
    outputs: list[Port] = field(default_factory=list)
    settings: int = 0
    kept: int = 0
    column: int = 0
    band: int = 0


#: Where a value comes from: an output of a box, or a signal of the program that is a setting.
_Source = Port | tuple[str, bool]


def block_box(block: Program, settings: Iterable[str] = ()) -> Box:
    """Return a block by itself, with all its ports.

    Parameters
    ----------
    settings : iterable of str
        Inputs that are only counted.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> total = Program("total", (), (Signal("u"),), (), (), Block(1, (), ()))
    >>> [port.name for port in block_box(total).inputs]
    ['u']
    """
    counted = set(settings)
    inputs = [_port(signal, 0) for signal in block.inputs if signal.name not in counted]
    outputs = [_port(signal, 0) for signal in block.outputs]
    return Box("", block.name, inputs, outputs, len(counted), len(own_state(block)))


def diagram(program: Program, settings: Iterable[str] = ()) -> list[Box]:
    """Return the boxes of a program whose calls own their state, in the order of its statements.

    Ports that get a constant and outputs that nothing reads are left out; ports that get only
    parameters are counted. A block that reads nothing but parameters gives parameters, and is left
    out as well.

    Parameters
    ----------
    settings : iterable of str
        Inputs that are parameters where the program is called itself.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.program.owned_state import with_owned_state
    >>> program = cl.design.simc(cl.load("quadruple-tank")).program()
    >>> boxes = diagram(with_owned_state(program))
    >>> [(box.title, box.settings, box.kept) for box in boxes[:2]]
    [('pump_1_loop', 6, 4), ('pump_2_loop', 6, 4)]
    """
    return _Reader(program, frozenset(settings)).boxes


class _Reader:
    def __init__(self, program: Program, settings: frozenset[str]) -> None:
        self.boxes: list[Box] = []
        self.read: dict[Port, list[_Source]] = {}
        entries = (*map(signal_of, program.state), *program.inputs, *program.parameters)
        given = settings.union(signal.name for signal in program.parameters)
        self.sources: dict[int, list[_Source]] = {
            k: [(entry.identifier, entry.name in given)] for k, entry in enumerate(entries)
        }
        self.direct = set(self.sources)
        self.kept = {signal_of(entry).identifier for entry in program.state}
        results = dict(zip(program.output_values, program.outputs, strict=True))
        for statement in program.block.without_unread().statements:
            if isinstance(statement, Call):
                self._call(statement)
                continue
            found = [s for value in read_by(statement) for s in self.sources[value]]
            for target in written_by(statement):
                self.sources[target] = list(dict.fromkeys(found))
                if target in results:
                    self._result(target, results[target].identifier)
        self._connect()
        ends = (*map(signal_of, program.state), *program.outputs)
        for value, signal in zip(program.block.results, ends, strict=True):
            for port in self.sources[value] if value in self.direct else []:
                if isinstance(port, Port):
                    port.names.append(signal.identifier)
        shown = {source for sources in self.read.values() for source in sources}
        for box in self.boxes:
            box.outputs = [port for port in box.outputs if port.names or port in shown]

    def _call(self, call: Call) -> None:
        block, number = call.program, len(self.boxes)
        states = len(block.state)
        given = list(zip(block.inputs, call.arguments[states:], strict=True))
        judged = [
            source
            for signal, value in given
            if signal.name != RESTART
            for source in self.sources[value]
        ]
        if judged and all(map(_is_setting, judged)):
            self.sources |= dict.fromkeys(call.targets, judged)
            return
        box = Box(call.identifier, block.name, kept=len(own_state(block)))
        for signal, value in given:
            found = self.sources[value]
            if all(map(_is_setting, found)):
                box.settings += bool(found)
                continue
            port = _port(signal, number, computed=value not in self.direct)
            box.inputs.append(port)
            self.read[port] = found
        box.outputs = [_port(signal, number) for signal in block.outputs]
        self.sources |= {target: [] for target in call.targets[:states]}
        for target, port in zip(call.targets[states:], box.outputs, strict=True):
            self.sources[target] = [port]
            self.direct.add(target)
        self.boxes.append(box)

    def _result(self, value: int, name: str) -> None:
        """Make an output that operations compute a box; what reads it further on names it."""
        box = Box(name)
        for source in self.sources[value]:
            of = source.name if isinstance(source, Port) else ""
            port = Port(of, len(self.boxes), computed=True)
            box.inputs.append(port)
            self.read[port] = [source]
        self.boxes.append(box)
        self.sources[value] = [(name, False)]

    def _connect(self) -> None:
        pairs = [
            (source, port)
            for port, sources in self.read.items()
            for source in sources
            if isinstance(source, Port)
        ]
        readers: defaultdict[Port, set[int]] = defaultdict(set)
        for source, port in pairs:
            readers[source].add(port.box)
        crowded = {s for s, found in readers.items() if not s.real and len(found) > _MOST_READERS}
        self._arrange([pair for pair in pairs if pair[0] not in crowded])
        for port, sources in self.read.items():
            names = [source[0] for source in sources if not isinstance(source, Port)]
            port.names += sorted(names, key=lambda name: name not in self.kept)
        for source, port in pairs:
            of, to = self.boxes[source.box], self.boxes[port.box]
            near = of.band == to.band and to.column - of.column <= _REACH[source.real]
            if near and source not in crowded:
                port.wires.append(source)
            else:
                port.names.append(self._name(source))

    def _arrange(self, wired: list[tuple[Port, Port]]) -> None:
        """Give every box a column behind what it reads, as near to its readers as can be."""
        for number, box in enumerate(self.boxes):
            behind = [self.boxes[s.box].column for s, port in wired if port.box == number]
            box.column = 1 + max(behind, default=-1)
        for number, box in reversed(list(enumerate(self.boxes))):
            ahead = [self.boxes[port.box].column for s, port in wired if s.box == number]
            box.column = min(ahead, default=box.column + 1) - 1
        columns = 1 + max((box.column for box in self.boxes), default=0)
        wide = math.ceil(columns / math.ceil(columns / _BAND))
        for box in self.boxes:
            box.band, box.column = divmod(box.column, wide)

    def _name(self, source: Port) -> str:
        """Return an output's name, with that of its box where another box has one so called."""
        owners = [box for box in self.boxes for port in box.outputs if port.name == source.name]
        box = self.boxes[source.box].title
        return source.name if len(owners) == 1 else f"{box}.{source.name}"


def _is_setting(source: _Source) -> bool:
    return isinstance(source, tuple) and source[1]


def _port(signal: Signal, box: int, *, computed: bool = False) -> Port:
    return Port(signal.identifier, box, signal.kind == "real", computed=computed)
