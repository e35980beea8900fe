"""Prints the statements of a block as LLVM code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from clepsydra.engine.bounded_roots import with_bounded_roots
from clepsydra.engine.elementary_functions import elementary_function
from clepsydra.engine.host import Host
from clepsydra.engine.refined_root import can_refine, endless_root, refined_root
from clepsydra.engine.step_order import Form, soonest_first
from clepsydra.engine.steps import Bounded, Known, Required, Same, Step
from clepsydra.engine.vector_rings import RingPrinter
from clepsydra.engine.vector_routines import RoutinePrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.engine.vector_turns import TurnPrinter
from clepsydra.engine.workspace import Workspace
from clepsydra.program.operation import LIBRARY, TO_SINGLE, Operation
from clepsydra.program.program import Block, Conditional, ForLoop, Statement, read_by
from clepsydra.program.routine import RoutineCall

_ARITHMETIC = {"add": "fadd", "subtract": "fsub", "multiply": "fmul", "divide": "fdiv"}
_COMPARE = {"less": "olt", "less_equal": "ole", "equal": "oeq", "not_equal": "une"}
_INTRINSIC = {"square_root": "sqrt", "absolute": "fabs", "floor": "floor", "ceiling": "ceil"}


class StatementPrinter:
    """Prints the statements of one block; `values` maps value numbers to LLVM names."""

    def __init__(
        self,
        text: VectorText,
        block: Block,
        values: dict[int, str],
        *,
        fuse: bool,
        rings: RingPrinter,
        workspace: Workspace | None = None,
        processor: Host | None = None,
    ) -> None:
        self.text = text
        self.block = block
        self.values = values
        self.fuse = fuse
        self.rings = rings
        self.workspace = workspace
        self.processor = processor
        self.products = _single_products(block) if fuse else {}
        #: The product that is fused into a sum, by the value of the sum.
        self.fused = dict(self._fusions(block))

    def print_all(self, statements: Iterable[Statement]) -> None:
        """Print statements; in whole vectors of a known processor as soon as each can begin."""
        steps: Iterable[Step] = statements
        if self.processor and self.text.lanes >= self.processor.lanes:
            bounded = with_bounded_roots(statements, self.block.made)
            steps = soonest_first([*bounded], self.form())
        for each in steps:
            self.step(each)

    def form(self) -> Form:
        """Return what decides how long the steps take."""
        refines = self.processor is not None and self.processor.refines
        return Form(
            self.text.lanes,
            refines and can_refine(self.text.lanes),
            self.read_by,
            lambda each: self.product_in(each) is not None,
        )

    def step(self, step: Step) -> None:
        """Print a step, and remember the names of its results."""
        if isinstance(step, Bounded):
            self.values[step.operation.target] = self._root(step)
        elif isinstance(step, Known):
            truth = "true" if step.truth else "false"
            self.values[step.target] = self.text.in_every_lane("i1", truth)
        elif isinstance(step, Same):
            self.values[step.target] = self.values[step.source]
        elif not isinstance(step, Required):
            self.statement(step)

    def _root(self, step: Bounded) -> str:
        if not step.refined:
            return self._operation(step.operation)
        given = self.values[step.operation.arguments[0]]
        return (endless_root if step.endless else refined_root)(self.text, given)

    def statement(self, statement: Statement) -> None:
        """Print a statement and remember the names of its results."""
        if isinstance(statement, ForLoop):
            self._loop(statement)
        elif isinstance(statement, Conditional):
            self._conditional(statement)
        elif isinstance(statement, RoutineCall):
            assert self.workspace is not None
            routines = RoutinePrinter(self.text, self.workspace, self._body)
            self.values.update(routines.call(statement, self.values))
        elif isinstance(statement, Operation):
            self.values[statement.target] = self._operation(statement)
        else:
            raise ValueError(f"{statement.instance}: a kernel computes blocks in place")

    def _body(self, body: Block, arguments: list[str]) -> list[str]:
        """Print the statements of a body and return the names of its results."""
        inner = dict(enumerate(arguments))
        printer = StatementPrinter(
            self.text, body, inner, fuse=self.fuse, rings=self.rings, workspace=self.workspace,
            processor=self.processor,
        )  # fmt: skip
        printer.print_all(body.statements)
        return [inner[result] for result in body.results]

    def _conditional(self, conditional: Conditional) -> None:
        """Branch around the body where no lane needs it, and select lane by lane behind it."""
        text, before = self.text, self.text.label
        label = text.new_label("when")
        condition = self.values[conditional.condition]
        carried = [self.values[value] for value in conditional.carried]
        needed = text.in_any_lane(condition)
        text.line(f"br i1 {needed}, label %{label}, label %{label}.done")
        text.begin(label)
        results = self._body(
            conditional.body, carried + [self.values[value] for value in conditional.invariants]
        )
        if text.lanes > 1:
            results = [
                text.choose(condition, result, start)
                for result, start in zip(results, carried, strict=True)
            ]
        inside = text.label
        text.line(f"br label %{label}.done")
        text.begin(f"{label}.done")
        for target, start, result in zip(conditional.targets, carried, results, strict=True):
            self.values[target] = text.assign(
                f"phi {text.real} [ {start}, %{before} ], [ {result}, %{inside} ]"
            )

    def _operation(self, operation: Operation) -> str:
        text, code = self.text, operation.code
        if code == "constant":
            return text.literal(operation.constant)
        product = self.product_in(operation)
        if product is not None:
            return self._fused(operation, product)
        given = [self.values[argument] for argument in operation.arguments]
        if code in _ARITHMETIC:
            return text.assign(f"{_ARITHMETIC[code]} {text.real} {given[0]}, {given[1]}")
        if code in _COMPARE:
            return text.compare(_COMPARE[code], *given)
        if code == "negate":
            return text.negative(given[0])
        if code == TO_SINGLE:
            return text.to_single(given[0])
        if code in _INTRINSIC:
            return text.intrinsic(_INTRINSIC[code], given)
        if code in ("minimum", "maximum"):
            condition = text.compare("olt" if code == "minimum" else "ogt", *given)
            return text.choose(condition, given[0], given[1])
        if code == "select":
            return text.choose(*given)
        if code == "number":
            return text.choose(given[0], text.literal(1.0), text.literal(0.0))
        if code == "truth":
            return text.compare("une", given[0], text.literal(0.0))
        if code == "not":
            return text.assign(f"xor {text.truth} {given[0]}, {text.all_true()}")
        if code in ("and", "or"):
            return text.assign(f"{code} {text.truth} {given[0]}, {given[1]}")
        if code in LIBRARY:
            return elementary_function(text, code, given)
        raise ValueError(f"the engine has no form for operation {code!r}")

    def read_by(self, statement: Statement) -> tuple[int, ...]:
        """Return the values that a printed statement reads: of a fused product, its factors."""
        product = self.product_in(statement)
        if product is None:
            return read_by(statement)
        rest = (value for value in read_by(statement) if value != product)
        return (*self.products[product], *rest)

    def product_in(self, statement: Statement) -> int | None:
        """Return the product that is fused into a statement, if any."""
        return self.fused.get(statement.target) if isinstance(statement, Operation) else None

    def _fusions(self, block: Block) -> Iterator[tuple[int, int]]:
        for each in block.statements if self.products else ():
            if isinstance(each, Operation) and each.fused and each.code in ("add", "subtract"):
                product = next((value for value in each.arguments if value in self.products), None)
                if product is not None:
                    yield each.target, product

    def _fused(self, operation: Operation, product: int) -> str:
        """Print a·b ± c as one fused multiply-add."""
        text, (left, right) = self.text, operation.arguments
        one, two = (self.values[factor] for factor in self.products[product])
        rest = self.values[right if product == left else left]
        if operation.code == "subtract":
            if product == left:
                rest = text.negative(rest)
            else:
                one = text.negative(one)
        return text.intrinsic("fma", [one, two, rest])

    def _loop(self, loop: ForLoop) -> None:
        text = self.text
        turns = TurnPrinter(text, loop, self.rings)
        label, before = turns.label, turns.before
        carried = [f"%{label}.c{i}" for i in range(len(loop.carried))]
        gaps = [text.gap() for _ in carried]
        turns.begin()
        rows, places = list(turns.rows()), turns.places()
        invariants = [self.values[value] for value in loop.invariants]
        results = self._body(loop.body, rows + carried + list(map(text.load, places)) + invariants)
        following, written = results[: len(carried)], results[len(carried) :]
        for value, place in zip(written, places, strict=True):
            text.store(value, place)
        turns.end()
        for gap, name, start, result in zip(gaps, carried, loop.carried, following, strict=True):
            text.fill(
                gap,
                f"{name} = phi {text.real} [ {self.values[start]}, %{before} ], "
                f"[ {result}, %{label}.end ]",
            )
        self.values.update(zip(loop.targets, following, strict=True))


def _single_products(block: Block) -> dict[int, tuple[int, ...]]:
    """Return the fusible products that are read exactly once, with their factors."""
    uses = block.uses()
    return {
        statement.target: statement.arguments
        for statement in block.statements
        if isinstance(statement, Operation)
        and statement.code == "multiply"
        and statement.fused
        and uses.get(statement.target) == 1
    }
