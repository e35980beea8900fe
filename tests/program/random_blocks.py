"""Random blocks, written down twice: plainly, statement by statement, and through the builder."""

import math
from dataclasses import dataclass, field

import numpy as np

from clepsydra.program.builder import BlockBuilder
from clepsydra.program.operation import COMPARISONS, LIBRARY, LOGIC, Operation
from clepsydra.program.program import Block, Conditional, ForLoop

NUMBERS = {
    **dict.fromkeys(("add", "subtract", "multiply", "divide", "minimum", "maximum"), 2),
    **dict.fromkeys(("negate", "square_root", "absolute", "floor", "ceiling"), 1),
    **{name: count for name, count in LIBRARY.items() if name != "copysign"},
}
EXACT_NUMBERS = [name for name in NUMBERS if name not in LIBRARY]
FINITE = (0.0, -0.0, 1.0, -1.0, 2.0, 0.5, 1e300, 1.1e300, 5e-324)
SPECIAL = (*FINITE, math.inf, -math.inf, math.nan)


@dataclass
class PlainBlock:
    """A block without any sharing or folding: one statement for each thing asked for."""

    arguments: int
    statements: list = field(default_factory=list)
    truths: set = field(default_factory=set)
    values: int = 0

    def __post_init__(self):
        self.values = self.arguments

    def _new(self) -> int:
        self.values += 1
        return self.values - 1

    def constant(self, value: float) -> int:
        target = self._new()
        self.statements.append(Operation(target, "constant", (), value))
        return target

    def operation(self, code: str, *arguments: int) -> int:
        first_is_truth = code in LOGIC or code in ("select", "number")
        wanted = [code in LOGIC or (first_is_truth and i == 0) for i in range(len(arguments))]
        given = [self._as(truth, value) for truth, value in zip(wanted, arguments, strict=True)]
        target = self._new()
        self.statements.append(Operation(target, code, tuple(given)))
        if code in LOGIC or code in COMPARISONS or code == "truth":
            self.truths.add(target)
        return target

    def loop(self, name, body, count, tables, carried, invariants) -> tuple[int, ...]:
        carried = tuple(self._as(False, value) for value in carried)
        invariants = tuple(self._as(False, value) for value in invariants)
        targets = tuple(self._new() for _ in carried)
        tables = tuple(tuple(map(float, table)) for table in tables)
        self.statements.append(ForLoop(targets, count, body, tables, carried, invariants, name))
        return targets

    def conditional(self, name, condition, body, carried, invariants) -> tuple[int, ...]:
        condition = self._as(True, condition)
        carried = tuple(self._as(False, value) for value in carried)
        invariants = tuple(self._as(False, value) for value in invariants)
        targets = tuple(self._new() for _ in carried)
        self.statements.append(Conditional(targets, condition, body, carried, invariants, name))
        return targets

    def finish(self, results) -> Block:
        results = tuple(self._as(False, value) for value in results)
        return Block(self.arguments, tuple(self.statements), tuple(results), frozenset(self.truths))

    def _as(self, truth: bool, value: int) -> int:
        if truth == (value in self.truths):
            return value
        return self.operation("truth" if truth else "number", value)


def random_block(
    seed: int,
    arguments: int,
    results: int,
    depth: int = 2,
    *,
    nesting: float = 0.04,
    library: bool = True,
    special: tuple[float, ...] = SPECIAL,
) -> tuple[Block, Block]:
    """Return the same random block plainly and through the builder.

    `nesting` is the share of loops and conditionals, one half each, `library` whether functions
    of the C library occur, `special` the constants that do beside ordinary numbers.
    """
    random = np.random.default_rng(seed)
    plain, built = PlainBlock(arguments), BlockBuilder(arguments)
    pool = [(i, i) for i in range(arguments)]

    def both(method: str, *given):
        pool.append((getattr(plain, method)(*given), getattr(built, method)(*given)))

    def operands(count: int):
        chosen = [pool[i] for i in random.integers(len(pool), size=count)]
        return [p for p, _ in chosen], [b for _, b in chosen]

    def operation(code: str, count: int):
        of_plain, of_built = operands(count)
        pool.append((plain.operation(code, *of_plain), built.operation(code, *of_built)))

    for _ in range(5):
        both("constant", float(random.choice([*special, random.normal()])))
    for _ in range(50):
        kind = random.random()
        if kind < 0.12:
            both("constant", float(random.choice([*special, random.normal()])))
        elif kind < 0.5 or (kind < 0.58 and not library):
            code = str(random.choice(EXACT_NUMBERS))
            operation(code, NUMBERS[code])
        elif kind < 0.58:
            code = str(random.choice(sorted(LIBRARY)))
            if code != "copysign":  # would show the sign of a not-a-number, which has none
                operation(code, LIBRARY[code])
        elif kind < 0.72:
            operation(str(random.choice(sorted(COMPARISONS))), 2)
        elif kind < 0.84:
            code = str(random.choice(["and", "or", "not"]))
            operation(code, 1 if code == "not" else 2)
        elif kind < 1 - nesting or depth == 0:
            operation("select", 3)
        else:
            branch = kind < 1 - nesting / 2
            tables, carried, invariants = (int(n) for n in random.integers(1, 4, size=3))
            tables = 0 if branch else tables
            bodies = random_block(
                int(random.integers(2**31)),
                tables + carried + invariants,
                carried,
                depth - 1,
                nesting=nesting,
                library=library,
                special=special,
            )
            start, held, condition = operands(carried), operands(invariants), operands(1)
            if branch:
                of_plain, of_built = (
                    block.conditional("branch", condition[i][0], bodies[i], start[i], held[i])
                    for i, block in enumerate((plain, built))
                )
                pool.extend(zip(of_plain, of_built, strict=True))
                continue
            count = int(random.integers(1, 5))
            table = random.normal(size=(tables, count)).tolist()
            of_plain = plain.loop("turns", bodies[0], count, table, start[0], held[0])
            of_built = built.loop("turns", bodies[1], count, table, start[1], held[1])
            pool.extend(zip(of_plain, of_built, strict=True))
    numbers = [pair for pair in pool if pair[0] not in plain.truths]
    late = numbers[-results:]
    return plain.finish([p for p, _ in late]), built.finish([b for _, b in late])


def stimulus(seed: int, samples: int, arguments: int) -> np.ndarray:
    """Return rows of ordinary numbers, with one entry in four a special one."""
    random = np.random.default_rng(seed)
    ordinary = random.normal(size=(samples, arguments)) * 3
    special = random.choice(SPECIAL, size=(samples, arguments))
    return np.where(random.random((samples, arguments)) < 0.25, special, ordinary)
