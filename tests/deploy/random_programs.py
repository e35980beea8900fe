"""Random programs of every statement, as the Python text that builds them, and scans for them.

What a strategy draws is the text of a small Python program: it is run to get the `Program`, and
it is what is shown of an example that fails, ready to be run again.
"""

import math
import re
import zlib
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from random_routines import IMPORT, routines

from clepsydra.program.operation import COMPARISONS, EXACT, LIBRARY, LOGIC
from clepsydra.program.program import Program

IMPORTS = f"""\
from math import inf

import casadi as ca
import numpy as np

from clepsydra import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program
from clepsydra import program_of
from clepsydra.program.step_law import Equations, step_law
{IMPORT}
"""

#: Numbers that printers, grammars and compilers like to get wrong; the simple ones come first.
NUMBERS = (
    1.0, 0.0, 2.0, -1.0, 0.5, -0.5, 3.0, 0.1, -0.0, -2.5, 1 / 3, 1e-5, 1e5, 7.0, 1e22, 1e23,
    2.0**31 - 1, 2.0**31, -(2.0**31), -(2.0**31) - 1, 2.0**24 + 1, 2.0**52 + 1, 2.0**53, 1e-300,
    -1e-300, 1e300, -1e300, 123456789.123456789, 2.2250738585072014e-308, 1e-310, 5e-324,
    -5e-324, 1.7976931348623157e308,
)  # fmt: skip
#: What arrives at an input beside them.
ARRIVING = (*NUMBERS, math.nan, math.inf, -math.inf, 1e301, -1e301)

#: Names that a printer uses itself, or that look like them; none has to be refused.
INNER_NAMES = (
    "t1", "t2", "i", "i_2", "state", "inputs", "outputs", "parameters", "memory", "turns_value",
    "turns_table", "oldest_ring_1", "next_turns_value", "large_number", "small_number",
    "law_step", "law_state", "a.b", "k", "n", "value", "model", "next_state", "position",
)  # fmt: skip
#: Names that one language or another must refuse: its words, or equal but for the case.
WRONG_NAMES = (
    "double", "REAL", "Step", "int", "limit", "level", "Level", "t", "T", "bool", "and", "END_IF",
    "class", "sqrt", "EN", "ring_1_position", "a_b", "A_B", "law", "int32_t", "INT32_MAX",
    "FP_NAN", "time", "lreal", "sizeof", "x" * 130,
)  # fmt: skip


class Written:
    """A random thing as the Python text that makes it; its text is what is shown of it."""

    def __init__(self, text: str, nasty: tuple[str, ...] = (), period: float = 1.0) -> None:
        self.text, self.period = text, period
        #: Names that may be refused.
        self.nasty = nasty

    def program(self) -> Program:
        scope: dict[str, object] = {}
        exec(compile(self.text, "<random>", "exec"), scope)
        found = scope["program"]
        assert isinstance(found, Program)
        return found

    def __repr__(self) -> str:
        return f"\n{self.text}"


numbers = st.sampled_from(NUMBERS)
#: Of initial values and tables: single precision has these too.
modest = st.sampled_from([x for x in NUMBERS if x == 0.0 or 1e-30 < abs(x) < 1e30])


@dataclass(frozen=True)
class Drawn:
    """The signals of a random program: their names and how they are written."""

    state: list[str]
    inputs: list[str]
    parameters: list[str]
    outputs: list[str]
    #: Of states, then of outputs.
    kinds: list[str]

    @property
    def arguments(self) -> int:
        return len(self.state) + len(self.inputs) + len(self.parameters)


@st.composite
def names(draw, count: int, wrong: bool) -> list[str]:
    """Different names; most are plain."""
    plain = [f"q{k}" for k in range(1, count + 1)]
    found: list[str] = []
    for own in plain:
        choice = draw(st.integers(0, 9))
        wanted = own
        if choice in (1, 2):
            wanted = draw(st.sampled_from(INNER_NAMES))
        elif choice == 3 and wrong:
            wanted = draw(st.sampled_from(WRONG_NAMES))
        known = {name.replace(".", "_") for name in found}
        found.append(own if wanted.replace(".", "_") in known else wanted)
    return found


@st.composite
def signals(draw, wrong: bool = False) -> Drawn:
    """States (numbers, integers, truth values, delay rings), inputs, parameters, outputs."""
    counts = [draw(st.integers(0, 4)), draw(st.integers(1, 4)), draw(st.integers(0, 3)),
              draw(st.integers(1, 4))]  # fmt: skip
    chosen = draw(names(sum(counts), wrong))
    groups = []
    for count in counts:
        groups.append(chosen[:count])
        chosen = chosen[count:]
    kinds: list[str] = []
    written: list[list[str]] = []
    for number, group in enumerate(groups):
        lines = []
        for name in group:
            allowed = ["real", "real", "integer", "boolean"] + ["ring"] * (number == 0)
            kind = draw(st.sampled_from(allowed))
            if number in (0, 3):
                kinds.append(kind)
            lines.append(draw(_signal(name, kind)))
        written.append(lines)
    return Drawn(*written, kinds)


@st.composite
def _signal(draw, name: str, kind: str) -> str:
    if kind == "ring":
        length = draw(st.sampled_from([1, 2, 3, 7]))
        return f"DelayRing(Signal({name!r}, initial={draw(modest)!r}), {length})"
    if kind == "boolean":
        initial = draw(st.sampled_from([0.0, 1.0]))
        return f"Signal({name!r}, low=0.0, high=1.0, initial={initial}, kind='boolean')"
    if kind == "integer":
        low, high = draw(st.sampled_from([(-5.0, 5.0), (0.0, 3.0), (-(2.0**20), 2.0**20)]))
        initial = draw(st.sampled_from([1.0, 0.0, 3.0]))
        return f"Signal({name!r}, low={low}, high={high}, initial={initial}, kind='integer')"
    return f"Signal({name!r}, initial={draw(modest)!r})"


class _Text:
    """The lines of a program while they are drawn."""

    def __init__(self, draw) -> None:
        self.draw = draw
        self.lines: list[str] = []
        self._count = 0
        # Arithmetic twice, so that it is drawn more often.
        self._codes: dict[int, list[str]] = {1: [], 2: sorted(_ARITHMETIC), 3: []}
        for code in sorted(EXACT - {"constant", "number", "truth"}):
            self._codes[_operands(code)].append(code)

    def new(self) -> str:
        self._count += 1
        return f"v{self._count}"

    def statements(self, builder: str, pool: list[str], most: int, depth: int) -> None:
        """Append statements of a block; the pool grows by their values."""
        for _ in range(self.draw(st.integers(1, most))):
            what = self.draw(st.integers(0, 9))
            if what == 7:
                self._routine(builder, pool)
            elif what == 8 and depth < 2:
                self._loop(builder, pool, depth)
            elif what == 9 and depth < 2:
                self._conditional(builder, pool, depth)
            elif what == 6:
                name = self.new()
                self.lines.append(f"{name} = {builder}.constant({self.draw(numbers)!r})")
                pool.append(name)
            else:
                self.operation(builder, pool)

    def one_of(self, pool: list[str]) -> str:
        return self.draw(st.sampled_from(pool))

    def operation(self, builder: str, pool: list[str], code: str = "", *given: str) -> str:
        size = self.draw(st.sampled_from([2, 2, 1, 3]))
        code = code or self.draw(st.sampled_from(self._codes[size]))
        operands = given or tuple(self.one_of(pool) for _ in range(_operands(code)))
        if code in COMPARISONS and operands[0] == operands[1]:
            # Compilers warn of what is compared with itself.
            operands = operands[0], self.constant(builder, 0.5)
        name = self.new()
        self.lines.append(f'{name} = {builder}.operation("{code}", {", ".join(operands)})')
        pool.append(name)
        return name

    def constant(self, builder: str, number: float) -> str:
        name = self.new()
        self.lines.append(f"{name} = {builder}.constant({number!r})")
        return name

    def _body(self, pool: list[str], depth: int, arguments: int, results: int) -> str:
        """Write a body with a builder of its own; return the name of its block."""
        builder, body = f"b{self._count + 1}", f"body{self._count + 1}"
        self._count += 1
        self.lines.append(f"{builder} = BlockBuilder({arguments})")
        inside = [str(k) for k in range(arguments)]
        self.statements(builder, inside, 5, depth + 1)
        chosen = [self.one_of(self._unread(inside)[::-1]) for _ in range(results)]
        self.lines.append(f"{body} = {builder}.finish([{', '.join(chosen)}])")
        return body

    def _values(self, least: int, pool: list[str]) -> list[str]:
        return [self.one_of(pool) for _ in range(self.draw(st.integers(least, 3)))]

    def _loop(self, builder: str, pool: list[str], depth: int) -> None:
        count = self.draw(st.sampled_from([1, 2, 3, 5]))
        tables = [
            [self.draw(modest) for _ in range(count)] for _ in range(self.draw(st.integers(0, 2)))
        ]
        carried, held = self._values(1, pool), self._values(0, pool)
        rings = []
        # A loop with rings runs in every scan, so that it stands in the outermost block.
        for _ in range(self.draw(st.integers(0, 2)) if depth == 0 else 0):
            self._count += 1
            length = self.draw(st.sampled_from([1, 2, 4]))
            ring = f'Signal("ring_{self._count}", initial={self.draw(modest)!r})'
            rings.append(f"DelayRing({ring}, {length})")
        arguments = len(tables) + len(carried) + len(rings) + len(held)
        body = self._body(pool, depth, arguments, len(carried) + len(rings))
        targets = [self.new() for _ in carried]
        self.lines.append(
            f'{", ".join(targets)}, = {builder}.loop("turns", {body}, {count}, {tables!r}, '
            f"[{', '.join(carried)}], [{', '.join(held)}], [{', '.join(rings)}])"
        )
        pool += targets

    def _routine(self, builder: str, pool: list[str]) -> None:
        self._count += 1
        made = self.draw(routines(f"routine_{self._count}"))
        values = [
            self.constant(builder, self.draw(modest)) if known else self.one_of(pool)
            for known in made.known
        ]
        targets = [self.new() for _ in range(made.results)]
        self.lines += made.lines
        self.lines.append(
            f"{', '.join(targets)}, = {builder}.routine({made.name}, [{', '.join(values)}])"
        )
        pool += targets

    def _conditional(self, builder: str, pool: list[str], depth: int) -> None:
        condition = self.operation(builder, pool, self.draw(st.sampled_from(sorted(COMPARISONS))))
        carried, held = self._values(1, pool), self._values(0, pool)
        body = self._body(pool, depth, len(carried) + len(held), len(carried))
        targets = [self.new() for _ in carried]
        self.lines.append(
            f'{", ".join(targets)}, = {builder}.conditional("branch", {condition}, {body}, '
            f"[{', '.join(carried)}], [{', '.join(held)}])"
        )
        pool += targets

    def _unread(self, pool: list[str]) -> list[str]:
        """What no statement reads yet, or the last values where there is nothing else."""
        read = " ".join(line.partition(" = ")[2] for line in self.lines)
        unread = [name for name in pool if not re.search(rf"\b{name}\b", read)]
        return unread or pool[-4:]

    def limited(self, value: str, low: float, high: float) -> str:
        value = self.operation("b", [], "maximum", value, self.constant("b", low))
        return self.operation("b", [], "minimum", value, self.constant("b", high))

    def result(self, pool: list[str], kind: str) -> str:
        """Choose what a state becomes or an output shows, in the kind that is declared."""
        value = self.one_of(self._unread(pool)[::-1])
        if kind == "boolean":
            return self.operation("b", [], self.draw(st.sampled_from(["less", "equal"])), value,
                                  self.one_of(pool))  # fmt: skip
        if kind == "integer" or self.draw(st.booleans()):
            low, high = self.draw(st.sampled_from([(-5.0, 5.0), (0.0, 7.0), (-(2.0**20), 1e6)]))
            if kind == "integer":
                value = self.operation("b", [], self.draw(st.sampled_from(["floor", "ceiling"])),
                                       value)  # fmt: skip
            # The limit second: it is what comes where the value is not a number.
            value = self.limited(value, low, high)
            # An integer has no negative zero; the engine, which has numbers only, would keep it.
            return self.operation("b", [], "add", value, self.constant("b", 0.0))
        return value


_ARITHMETIC = ("add", "subtract", "multiply", "divide")
_FOLDING = ("sin", "cos", "tan", "fmod")
_UNARY = frozenset({"negate", "square_root", "absolute", "floor", "ceiling", "not"})


def _operands(code: str) -> int:
    return 3 if code == "select" else LIBRARY.get(code, 1 if code in _UNARY else 2)


@st.composite
def programs(draw, wrong: bool = False) -> Written:
    """A program of operations, loops with and without rings, and conditionals."""
    drawn = draw(signals(wrong))
    text = _Text(draw)
    pool = [str(k) for k in range(drawn.arguments)]
    text.statements("b", pool, 16, 0)
    results = [text.result(pool, kind) for kind in drawn.kinds]
    named = {
        draw(st.sampled_from(pool)): draw(st.sampled_from([*INNER_NAMES, "9 lives", "é", "while"]))
        for _ in range(draw(st.integers(0, 3)))
    }
    return Written(_program_text(drawn, text.lines, results, named), _nasty(drawn))


@st.composite
def library_programs(draw) -> Written:
    """A program whose outputs are functions of a library, of what is exact until then."""
    drawn = draw(signals())
    text = _Text(draw)
    pool = [str(k) for k in range(drawn.arguments)]
    text.statements("b", pool, 6, 1)
    results = [text.result(pool, kind) for kind in drawn.kinds]
    last = len(drawn.state)
    for place, kind in enumerate(drawn.kinds[last:], start=last):
        if kind == "real":
            code = draw(st.sampled_from(sorted(LIBRARY)))
            given = [text.one_of(pool[: drawn.arguments]) for _ in range(LIBRARY[code])]
            if code in _FOLDING:
                # Of what is too large they tell nothing (see KNOWN_GAPS).
                given = [text.limited(each, -1e6, 1e6) for each in given]
                given[1:] = [text.limited(each, 1e-3, 1e6) for each in given[1:]]
            results[place] = text.operation("b", [], code, *given)
    return Written(_program_text(drawn, text.lines, results, {}))


def _nasty(drawn: Drawn) -> tuple[str, ...]:
    every = [*drawn.state, *drawn.inputs, *drawn.parameters, *drawn.outputs]
    return tuple(name for name in WRONG_NAMES if any(repr(name) in entry for entry in every))


def _program_text(drawn: Drawn, lines: list[str], results: list[str], named: dict) -> str:
    groups = {
        name: "(" + "".join(f"\n    {entry}," for entry in getattr(drawn, name)) + "\n)"
        for name in ("state", "inputs", "parameters", "outputs")
    }
    body = "\n".join([f"b = BlockBuilder({drawn.arguments})", *lines])
    names_text = ", ".join(f"{value}: {name!r}" for value, name in named.items())
    return (
        f"{IMPORTS}\n"
        + "".join(f"{name} = {text}\n" for name, text in groups.items())
        + f"{body}\nblock = b.finish([{', '.join(results)}])\n"
        + 'program = Program("law", state, inputs, parameters, outputs, block, '
        + f"{{{names_text}}})\n"
    )


def odd_scans(program: Program, scans: int, seed: int) -> dict[str, np.ndarray]:
    """Random values of inputs and parameters: usual ones, and every odd one there is.

    An integer stays in the range that it is declared with, a parameter keeps its printed value
    for half of the time (it is not a number then).
    """
    found = {}
    for signal in (*program.inputs, *program.parameters):
        random = np.random.default_rng((seed, zlib.crc32(signal.name.encode())))
        if signal.kind == "real":
            usual = random.normal(scale=random.choice([0.1, 3.0, 1e3], scans))
            odd = random.choice(np.array(ARRIVING), scans)
            values = np.where(random.random(scans) < 0.4, odd, usual)
        else:
            low, high = max(signal.low, -(2.0**31)), min(signal.high, 2.0**31 - 1)
            values = random.integers(int(low), int(high), scans, endpoint=True).astype(float)
            ends = random.choice([low, high], scans)
            values = np.where(random.random(scans) < 0.2, ends, values)
        held = random.random(scans) < 0.3
        held[0] = False
        values = values[np.maximum.accumulate(np.where(held, 0, np.arange(scans)))]
        if signal in program.parameters:
            values = np.where(random.random(scans) < 0.5, math.nan, values)
        found[signal.name] = values
    return found


def codes_of(program: Program) -> set[str]:
    """What a program is made of: codes of operations, and what else a block may have."""
    found = {operation.code for operation in program.block.operations()}
    found |= {"ring" for entry in program.state if hasattr(entry, "length")}
    return found | set(_statements(program.block, ""))


def _statements(block, outside: str):
    for statement in block.statements:
        kind = type(statement).__name__
        if kind != "Operation":
            yield f"{outside}{kind}"
            if getattr(statement, "rings", ()):
                yield "rings of a loop"
            if getattr(statement, "count", 0) == 1:
                yield "a single turn"
            if kind != "RoutineCall":
                yield from _statements(statement.body, f"{kind} in ")


EVERYTHING = (
    (EXACT | LOGIC | COMPARISONS)
    | {"ring", "ForLoop", "Conditional", "RoutineCall", "rings of a loop", "a single turn"}
    | {
        "ForLoop in ForLoop",
        "Conditional in ForLoop",
        "ForLoop in Conditional",
        "Conditional in Conditional",
        "ForLoop in RoutineCall",
        "Conditional in RoutineCall",
    }
)
